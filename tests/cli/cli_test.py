"""The command line as its users meet it: exit codes, one-line errors, files whole or not there.

Oracles: docs/cli.md for the codes, the JSON, CSV and zip readers of Python for what is written, brute force (--verify)
for answers. The program to test is named by the environment variable RAYWISE.
"""

import csv
import io
import json
import os
import pty
import signal
import struct
import subprocess
import tempfile
import time
import unittest
import xml.etree.ElementTree
import zipfile
import zlib

PROGRAM = os.environ["RAYWISE"]
OK, USAGE, INPUT, LIMIT, IO = 0, 2, 3, 4, 5
TINY = ["--generate", "random:300"]

TETRAHEDRON = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
"""


def run(*arguments, **options):
    options.setdefault("stdout", subprocess.PIPE)
    return subprocess.run([PROGRAM, *arguments], stderr=subprocess.PIPE, timeout=120, **options)


class CliTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="raywise_cli_")
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def files(self):
        return sorted(os.listdir(self.folder.name))

    def succeed(self, *arguments, **options):
        result = run(*arguments, **options)
        self.assertEqual(result.returncode, OK, result.stderr)
        return result.stdout

    def fail(self, code, *arguments, **options):
        """Runs what must end with the code and one line of at most 300 bytes; gives that line."""
        result = run(*arguments, **options)
        self.assertEqual(result.returncode, code, (arguments, result.stdout, result.stderr))
        lines = result.stderr.decode("utf-8").splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertLessEqual(len(result.stderr), 300)
        self.assertTrue(lines[0].startswith("raywise: "), lines[0])
        self.assertTrue(lines[0].isprintable(), lines[0])
        return lines[0]


class Usage(CliTest):
    def test_help_and_version_go_to_standard_output(self):
        self.assertIn(b"compare", self.succeed("--help"))
        self.assertRegex(self.succeed("--version"), rb"^raywise \d+\.\d+\.\d+")
        for command in ("info", "build", "trace", "compare", "convert", "bench"):
            self.assertIn(b"--format", self.succeed(command, "--help"))

    def test_unknown_words_are_met_with_the_nearest_known_one(self):
        self.assertIn("did you mean 'compare'?", self.fail(USAGE, "compar"))
        self.assertIn("did you mean '--format'?", self.fail(USAGE, "info", *TINY, "--fromat", "csv"))
        self.assertIn("did you mean 'courtyard'?", self.fail(USAGE, "info", "--generate", "courtyrad:1000"))
        self.assertIn("did you mean 'SAH/all'?", self.fail(USAGE, "compare", *TINY, "--pairs", "SAH/al"))

    def test_a_command_line_that_cannot_be_followed_is_a_usage_error(self):
        for arguments in (
            [],
            ["info"],
            ["info", "a.ply", "--generate", "random:300"],
            ["info", "a.ply", "b.ply"],
            ["info", *TINY, "--format", "xml"],
            ["info", *TINY, "--seed", "-1"],
            ["info", *TINY, "--seed", "one"],
            ["info", *TINY, "--threads", "1025"],
            ["info", "--generate", "random:many"],
            ["info", *TINY, "--max-memory", "lots"],
            ["trace", *TINY],
            ["trace", *TINY, "--sample", "5", "--rays", "rays.npy"],
            ["trace", *TINY, "--sample", "5", "--fast", "--verify", "5"],
            ["trace", *TINY, "--sample", "5", "--fast", "--tree", "tree.rwtree"],
            ["compare", *TINY, "--seeds", "0"],
            ["convert", *TINY],
        ):
            self.fail(USAGE, *arguments)

    def test_control_characters_are_escaped(self):
        self.assertIn(r"\x1b", self.fail(USAGE, "a\x1b[31mb\nc"))


class Input(CliTest):
    def test_broken_scenes_are_refused_with_their_name(self):
        cut = TETRAHEDRON.encode()[:-20]
        binary = b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
        binary += b"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\0\0\0"
        for name, content in {
            "cut.ply": cut,
            "huge.ply": binary,
            "empty.ply": b"",
            "garbage.ply": bytes(range(256)) * 8,
            "garbage.obj": bytes(range(256)) * 8,
            "garbage.stl": b"solid" + bytes(range(256)),
            "garbage.glb": b"glTF" + bytes(range(256)),
            "garbage.gltf": b"{]",
            "unknown.xyz": b"1 2 3",
            "index.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 17\n",
            "none.obj": b"v 0 0 0\n",
        }.items():
            with self.subTest(name):
                self.assertIn(name, self.fail(INPUT, "info", self.write(name, content)))

    def test_line_of_the_fault_is_named(self):
        path = self.write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 17\n")
        self.assertIn("index.obj:4: ", self.fail(INPUT, "info", path))

    def test_what_cannot_be_read_is_an_input_output_error(self):
        self.assertIn("none.ply", self.fail(IO, "info", self.path("none.ply")))
        os.mkdir(self.path("folder.ply"))
        self.fail(IO, "info", self.path("folder.ply"))
        os.mkfifo(self.path("pipe.ply"))
        self.fail(IO, "info", self.path("pipe.ply"))

    def test_invalid_triangles_are_refused_or_dropped_and_counted(self):
        path = self.write("nan.ply", TETRAHEDRON.replace("0 0 1\n", "0 0 nan\n"))
        self.fail(INPUT, "info", path)
        result = run("info", path, "--skip-invalid", "--format", "json")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(json.loads(result.stdout)["rows"][0]["triangles"], 1)
        self.assertIn(b"3 invalid triangles", result.stderr)

    def test_memory_limit_is_refused_before_it_is_reached(self):
        path = self.write("many.ply", TETRAHEDRON + " " * 100000)
        self.fail(LIMIT, "info", path, "--max-memory", "50K")
        self.fail(LIMIT, "build", *TINY, "--max-memory", "10K")

    def test_broken_area_files_are_refused(self):
        for text in ("{", "[]", '{"schema_version": 1, "areas": [{"name": "a", "kind": "parallel", "dir": [0, 0, 1]}]}'):
            path = self.write("areas.json", text)
            self.assertIn("areas.json", self.fail(INPUT, "compare", *TINY, "--areas", path))

    def test_broken_ray_and_tree_files_are_refused(self):
        path = self.write("rays.npy", b"\x93NUMPY garbage")
        self.assertIn("rays.npy", self.fail(INPUT, "trace", *TINY, "--rays", path))
        path = self.write("tree.rwtree", b"garbage" * 20)
        self.assertIn("tree.rwtree", self.fail(INPUT, "trace", *TINY, "--sample", "5", "--tree", path))

    def test_a_tree_of_another_scene_is_refused(self):
        tree = self.path("tree.rwtree")
        self.succeed("build", *TINY, "-o", tree)
        self.assertIn(
            "another scene", self.fail(INPUT, "trace", "--generate", "random:200", "--sample", "5", "--tree", tree)
        )


class Output(CliTest):
    def test_a_full_disk_is_an_input_output_error(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        with open("/dev/full", "wb") as full:
            self.fail(IO, "info", *TINY, stdout=full)
            self.fail(IO, "--help", stdout=full)
        self.fail(IO, "info", *TINY, "-o", "/dev/full")
        self.assertTrue(os.path.exists("/dev/full"))

    def test_a_closed_pipe_is_an_input_output_error(self):
        reader, writer = os.pipe()
        os.close(reader)
        try:
            self.fail(IO, "info", *TINY, stdout=writer)
        finally:
            os.close(writer)

    def test_an_unwritable_place_leaves_nothing_behind(self):
        os.mkdir(self.path("folder"))
        self.fail(IO, "info", *TINY, "-o", self.path("folder"))
        self.fail(IO, "info", *TINY, "-o", self.path("none/report"))
        self.fail(IO, "convert", *TINY, self.path("none/scene.ply"))
        self.assertEqual(self.files(), ["folder"])

    def test_reports_are_the_same_in_every_format(self):
        table = self.succeed("info", *TINY).decode()
        self.assertRegex(table, r"triangles +300\n")
        document = json.loads(self.succeed("info", *TINY, "--format", "json"))
        rows = list(csv.DictReader(io.StringIO(self.succeed("info", *TINY, "--format", "csv").decode())))
        self.assertEqual(document["schema_version"], 1)
        self.assertEqual(len(rows), 1)
        self.assertEqual(document["rows"][0]["triangles"], 300)
        self.assertEqual(int(rows[0]["triangles"]), 300)
        self.assertEqual(float(rows[0]["hi_x"]), document["rows"][0]["hi_x"])
        for key in ("version", "compiler", "cpu", "threads", "seed", "scene_hash", "cost_node", "command"):
            self.assertIn(key, document["provenance"])
            self.assertIn(key, rows[0])

    def test_a_report_in_a_file_equals_that_on_standard_output(self):
        self.succeed("info", *TINY, "--format", "json", "-o", self.path("info.json"))
        with open(self.path("info.json"), encoding="utf-8") as file:
            written = json.load(file)
        self.assertEqual(written["rows"], json.loads(self.succeed("info", *TINY, "--format", "json"))["rows"])
        self.assertEqual(self.files(), ["info.json"])

    def test_quiet_says_nothing(self):
        result = run("convert", *TINY, self.path("a.ply"), "--quiet")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (OK, b"", b""))

    def test_color_only_on_a_terminal_and_never_with_no_color(self):
        def error_on_terminal(environment):
            ours, theirs = pty.openpty()
            try:
                subprocess.run([PROGRAM, "nonsense"], stderr=theirs, env={**os.environ, **environment}, timeout=60)
                return os.read(ours, 4096)
            finally:
                os.close(ours)
                os.close(theirs)

        self.assertIn(b"\x1b[", error_on_terminal({"NO_COLOR": ""}))
        self.assertNotIn(b"\x1b[", error_on_terminal({"NO_COLOR": "1"}))
        self.assertNotIn(b"\x1b", run("nonsense").stderr)


class Configuration(CliTest):
    def test_dumped_configuration_gives_the_same_run(self):
        options = ["--seed", "9007199254740993", "--measure", "sah", "--axes", "longest", "--quiet"]
        dumped = self.succeed("build", *TINY, *options, "--dump-config")
        self.assertEqual(json.loads(dumped)["seed"], 9007199254740993)
        path = self.write("build.json", dumped)
        self.assertEqual(self.succeed("build", "--config", path, "--dump-config"), dumped)
        row = json.loads(self.succeed("build", "--config", path, "--format", "json"))["rows"][0]
        same = json.loads(self.succeed("build", *TINY, *options, "--format", "json"))["rows"][0]
        for timed in (row, same):
            del timed["build_ms"]
        self.assertEqual(row, same)

    def test_command_line_goes_before_the_file(self):
        path = self.write("info.json", '{"generate": "random:300", "format": "json", "seed": 7}')
        document = json.loads(self.succeed("info", "--config", path, "--seed", "8"))
        self.assertEqual(document["provenance"]["seed"], 8)

    def test_faults_in_the_file_are_refused(self):
        for text, reason in {
            '{"fromat": "csv"}': "did you mean 'format'?",
            '{"format": "xml"}': "format",
            '{"seed": 1, "seed": 2}': "twice",
            '{"seed": [1]}': "seed",
            '{"command": "build"}': "build",
            "[]": "not a JSON object",
            '{"seed": ': "byte",
        }.items():
            path = self.write("info.json", text)
            with self.subTest(text):
                line = self.fail(INPUT, "info", *TINY, "--config", path)
                self.assertIn(reason, line)
                self.assertIn("info.json", line)
        self.fail(IO, "info", "--config", self.path("none.json"))


class Convert(CliTest):
    def test_formats_keep_what_rays_can_meet(self):
        self.succeed("convert", "--generate", "courtyard:1000", self.path("a.glb"))
        hashes = set()
        source = self.path("a.glb")
        for suffix in ("ply", "obj", "stl"):
            target = self.path("b." + suffix)
            self.succeed("convert", source, target)
            row = json.loads(self.succeed("info", target, "--format", "json"))["rows"][0]
            hashes.add(row["content_hash"])
        hashes.add(json.loads(self.succeed("info", source, "--format", "json"))["rows"][0]["content_hash"])
        self.assertEqual(len(hashes), 1)

    def test_an_unknown_suffix_is_refused_and_nothing_written(self):
        self.fail(INPUT, "convert", *TINY, self.path("a.xyz"))
        self.assertEqual(self.files(), [])


class Build(CliTest):
    def test_every_heuristic_builds_the_same_file_for_any_number_of_threads(self):
        for measure in ("sah", "pah", "mixed", "measured"):
            contents = set()
            for threads in ("1", "2"):
                path = self.path("tree.rwtree")
                self.succeed(
                    "build", *TINY, "--measure", measure, "--area", "sun", "--threads", threads, "-o", path
                )
                with open(path, "rb") as file:
                    contents.add(file.read())
            self.assertEqual(len(contents), 1, measure)

    def test_an_area_must_be_named_when_there_are_several(self):
        line = self.fail(USAGE, "build", *TINY, "--measure", "pah")
        self.assertIn("sun", line)
        self.assertIn("did you mean 'sun'?", self.fail(USAGE, "build", *TINY, "--measure", "pah", "--area", "son"))


class Trace(CliTest):
    def trace(self, *arguments):
        return json.loads(self.succeed("trace", *TINY, *arguments, "--format", "json"))["rows"][0]

    def test_areas_and_a_tree_file_give_the_same_hits_and_brute_force_agrees(self):
        rays, tree = self.path("rays.npy"), self.path("tree.rwtree")
        self.succeed("build", *TINY, "-o", tree)
        row = self.trace("--sample", "200", "--save-rays", rays, "--verify", "600", "-o", self.path("a.npz"))
        self.assertEqual((row["rays"], row["verified_rays"], row["mismatches"]), (600, 600, 0))
        self.assertGreater(row["hits"], 0)
        self.trace("--rays", rays, "--tree", tree, "-o", self.path("b.npz"))
        members = []
        for name in ("a.npz", "b.npz"):
            with zipfile.ZipFile(self.path(name)) as archive:
                self.assertIsNone(archive.testzip())
                members.append({member: archive.read(member) for member in archive.namelist()})
        self.assertEqual(members[0], members[1])
        self.assertIn("t.npy", members[0])

    def test_any_hit_finds_as_many_and_writes_one_flag_per_ray(self):
        closest = self.trace("--sample", "100")
        path = self.path("any.npy")
        occluded = self.trace("--sample", "100", "--any", "--verify", "300", "-o", path)
        self.assertEqual((occluded["hits"], occluded["mismatches"]), (closest["hits"], 0))
        with open(path, "rb") as file:
            content = file.read()
        self.assertEqual(content[:8], b"\x93NUMPY\x01\x00")
        flags = content[10 + struct.unpack("<H", content[8:10])[0] :]
        self.assertEqual((len(flags), sum(flags)), (300, closest["hits"]))


def read_png(path):
    """Width and height of an 8-bit RGB file whose checksums are right and whose rows are complete."""
    with open(path, "rb") as file:
        content = file.read()
    assert content[:8] == b"\x89PNG\r\n\x1a\n"
    position, pixels, size = 8, b"", None
    while position < len(content):
        length, kind = struct.unpack(">I4s", content[position : position + 8])
        body = content[position + 8 : position + 8 + length]
        assert struct.unpack(">I", content[position + 8 + length : position + 12 + length])[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            size = struct.unpack(">II", body[:8])
            assert body[8:10] == b"\x08\x02"
        if kind == b"IDAT":
            pixels += body
        position += 12 + length
    assert len(zlib.decompress(pixels)) == (3 * size[0] + 1) * size[1]
    return size


class Compare(CliTest):
    ARGUMENTS = ["compare", *TINY, "--rays", "200", "--seeds", "2", "--repeats", "0"]

    def test_ends_with_verified_answers_and_a_verdict_per_area(self):
        text = self.succeed(*self.ARGUMENTS).decode()
        self.assertIn("SAH/all", text)
        self.assertRegex(text, r"Answers verified: .* 0 mismatches")
        for area in ("sun", "lamp", "camera"):
            self.assertRegex(text, rf"(?m)^{area}: use ")

    def test_csv_and_json_hold_the_same_rows_for_any_number_of_threads(self):
        document = json.loads(self.succeed(*self.ARGUMENTS, "--format", "json", "--threads", "1"))
        rows = list(csv.DictReader(io.StringIO(self.succeed(*self.ARGUMENTS, "--format", "csv", "--threads", "2").decode())))
        self.assertEqual(len(rows), len(document["rows"]))
        for a, b in zip(rows, document["rows"]):
            for name, value in b.items():
                text = "" if value is None else str(value).lower() if isinstance(value, bool) else value
                self.assertEqual(a[name] if isinstance(text, str) else float(a[name]), text, name)
        self.assertEqual({row["mismatches"] for row in document["rows"]}, {0})
        self.assertTrue(all(row["verified_rays"] > 0 for row in document["rows"]))

    def test_pairs_are_those_asked_for_and_the_baseline(self):
        document = json.loads(self.succeed(*self.ARGUMENTS, "--pairs", "PAH/facing", "--format", "json"))
        self.assertEqual({row["pair"] for row in document["rows"]}, {"PAH/facing", "SAH/all"})

    def test_faithful_runs_compare_the_pairs_of_the_thesis(self):
        document = json.loads(self.succeed("compare", *TINY, "--faithful", "--rays", "200", "--format", "json"))
        self.assertEqual(
            {row["pair"] for row in document["rows"]}, {"PAH/facing", "SAH/facing", "PAH/longest", "SAH/longest"}
        )

    def test_heat_maps_are_pictures(self):
        folder = self.path("maps")
        self.succeed(*self.ARGUMENTS, "--pairs", "PAH/facing", "--heat-maps", folder)
        names = sorted(os.listdir(folder))
        self.assertIn("sun.png", names)
        self.assertIn("sun-PAH_facing.png", names)
        for name in names:
            width, height = read_png(os.path.join(folder, name))
            self.assertGreater(min(width, height), 50)


class Bench(CliTest):
    ARGUMENTS = ["bench", "--quick", "--paths", "4096"]
    KEYS = (
        "scene rays kind query peer ours_mrays peer_mrays ratio spread verified mismatches node_visits triangle_tests"
    ).split()

    def setUp(self):
        super().setUp()
        if b"without Embree" in run(*self.ARGUMENTS, "random:300").stderr:
            self.skipTest("built without Embree")

    def rows(self, *arguments):
        report = json.loads(self.succeed(*self.ARGUMENTS, *arguments, "--format", "json"))
        return report["rows"], report

    def test_every_class_is_verified_and_timed_beside_both_peers(self):
        rows, report = self.rows("city:1000")
        kinds = {}
        for row in rows:
            for key in self.KEYS:
                self.assertIn(key, row)
            self.assertEqual(row["mismatches"], 0, row)
            self.assertIs(row["verified"], True)
            self.assertGreater(row["ours_mrays"], 0, row)
            self.assertGreater(row["ratio"], 0, row)
            kinds.setdefault(row["kind"], set()).add((row["rays"], row["peer"]))
        self.assertEqual({kind: len(pairs) for kind, pairs in kinds.items()}, {"exact": 6, "near_affine": 8, "general": 2})
        self.assertEqual({row["peer"] for row in rows}, {"embree_single", "embree_best"})
        self.assertIn("Embree 3.", report["provenance"]["peer"])
        self.assertTrue(any("of ours" in finding for finding in report["findings"]))
        for table in ("builds", "break_even", "limits"):
            self.assertTrue(report[table], table)

    def test_rays_depend_on_the_seed_and_nothing_else(self):
        def hashes(*arguments):
            return [row["ray_hash"] for row in self.rows("spheres:500", *arguments)[0]]

        self.assertEqual(hashes("--threads", "1"), hashes("--threads", "2"))
        self.assertNotEqual(hashes(), hashes("--seed", "2"))

    def test_a_structure_can_be_forced(self):
        for structure in ("none", "wide_tree", "framed_tree", "pencil_grid", "inversion"):
            rows, _ = self.rows("spheres:500", "--classes", "sun,area_light", "--structure", structure)
            for row in rows:
                self.assertEqual(row["mismatches"], 0, row)
                if row["kind"] == "exact":
                    self.assertEqual(row["structure"], structure)
        self.assertIn("did you mean 'wide_tree'?", self.fail(USAGE, "bench", "random:300", "--structure", "widetree"))

    def test_folders_files_and_recipes_are_scenes(self):
        self.write("b.ply", TETRAHEDRON)
        self.write("a.ply", TETRAHEDRON)
        self.write("notes.txt", "no scene")
        rows, _ = self.rows(self.folder.name, "random:300", "--classes", "primary")
        self.assertEqual([row["scene"] for row in rows[::2]], ["a", "b", "random:300"])

    def test_scaling_reports_growth_and_threads(self):
        _, report = self.rows("terrain:500", "terrain:5000", "city:500", "--classes", "primary")
        self.assertEqual({row["scene"] for row in report["growth"]}, {"terrain"})
        rows, report = self.rows("--scaling", "terrain", "--largest", "10000")
        self.assertEqual({row["scene"] for row in rows}, {"terrain:10000"})
        self.assertEqual(len(report.get("threads", [])), 4 if os.cpu_count() > 1 else 0)

    def test_the_chart_is_an_image_with_a_bar_per_class_and_peer(self):
        chart = self.path("chart.svg")
        self.succeed(*self.ARGUMENTS, "random:300", "--classes", "primary,sun", "--chart", chart)
        root = xml.etree.ElementTree.parse(chart).getroot()
        self.assertTrue(root.tag.endswith("svg"))
        words = [element.text for element in root.iter() if element.tag.endswith("text")]
        self.assertEqual(words.count("sun"), 1)
        self.assertIn("random:300", words)

    def test_what_cannot_be_measured_is_one_line(self):
        self.assertIn("did you mean 'primary'?", self.fail(USAGE, "bench", "random:300", "--classes", "primray"))
        self.assertIn("did you mean 'city'?", self.fail(USAGE, "bench", "citty:300"))
        self.assertIn("SVG", self.fail(USAGE, "bench", "random:300", "--chart", "chart.jpg"))
        self.assertIn("no scene files", self.fail(USAGE, "bench", self.folder.name))
        self.assertIn("--scaling", self.fail(USAGE, "bench", "--scaling", "city:300"))
        self.fail(USAGE, "bench")
        self.fail(USAGE, "bench", "random:300", "--emitters", "65")
        self.fail(IO, "bench", self.path("none.ply"))
        self.fail(INPUT, "bench", self.write("cut.ply", TETRAHEDRON[:-20]))
        self.fail(LIMIT, "bench", "terrain:100000", "--max-memory", "1M")
        self.assertEqual(self.files(), ["cut.ply"])


class Signals(CliTest):
    def test_signals_stop_the_work_and_leave_nothing_half_written(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen(
                [PROGRAM, "compare", "--generate", "courtyard:20000", "--rays", "1000000", "-o", self.path("report")],
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
            )
            time.sleep(1)
            process.send_signal(number)
            try:
                _, errors = process.communicate(timeout=60)
            finally:
                process.kill()
            self.assertEqual(process.returncode, 128 + number, errors)
            self.assertEqual(len(errors.splitlines()), 1, errors)
            self.assertEqual(self.files(), [])


if __name__ == "__main__":
    unittest.main()
