// raywise bench: rays per second beside Embree, same rays, verified answers.
#include "bench/chart.hpp"
#include "bench/class_bench.hpp"
#include "bench/report.hpp"
#include "bench/rows.hpp"
#include "bench/scaling.hpp"
#include "bench/scene_bench.hpp"
#include "exit_code.hpp"
#include "output.hpp"
#include "peer/embree.hpp"
#include "scene_source.hpp"
#include "session.hpp"

#include <raywise/analysis/ray_class.hpp>
#include <raywise/core/nearest_word.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/io/report.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/structure_choice.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace raywise::app {

namespace {

struct BenchOptions {
    std::vector<std::string> scenes;
    SceneOptions common;
    std::string classes;
    std::string chart;
    std::string structure;
    bool quick = false;
    bool scaling = false;
    std::size_t largest = 0;
    std::size_t paths = 0;
    int emitters = 0;
};

// Bytes per triangle of both sides' structures, an accelerator's areas among them.
constexpr std::uint64_t bytes_per_triangle = 3000;

std::vector<std::string> class_names() {
    std::vector<std::string> names;
    for (const RayClass rays : all_ray_classes())
        names.emplace_back(name_of(rays));
    return names;
}

/// "primary,sun" as classes. Throws UsageError for a name that there is not.
std::vector<RayClass> parse_classes(const std::string& text) {
    const auto known = all_ray_classes();
    if (text.empty()) return {known.begin(), known.end()};
    const std::vector<std::string> names = class_names();
    std::vector<RayClass> classes;
    std::istringstream stream(text);
    for (std::string name; std::getline(stream, name, ',');) {
        const auto at = std::find(names.begin(), names.end(), name);
        if (at == names.end())
            throw UsageError(fmt::format(
                "--classes: unknown class '{}'{} (there are {})",
                name,
                did_you_mean(name, names),
                fmt::join(names, ", ")
            ));
        const RayClass rays = known[static_cast<std::size_t>(at - names.begin())];
        if (std::find(classes.begin(), classes.end(), rays) == classes.end())
            classes.push_back(rays);
    }
    if (classes.empty()) throw UsageError("--classes names no class");
    return classes;
}

/// Nothing for "auto". Throws UsageError for a name that there is not.
std::optional<StructureKind> parse_structure(const std::string& text) {
    if (text.empty() || text == "auto") return std::nullopt;
    std::vector<std::string> names = {"auto"};
    for (const StructureKind kind :
         {StructureKind::none,
          StructureKind::binary_tree,
          StructureKind::wide_tree,
          StructureKind::framed_tree,
          StructureKind::pencil_grid,
          StructureKind::inversion}) {
        if (text == name_of(kind)) return kind;
        names.emplace_back(name_of(kind));
    }
    throw UsageError(fmt::format(
        "--structure: unknown structure '{}'{} (there are {})",
        text,
        did_you_mean(text, names),
        fmt::join(names, ", ")
    ));
}

BenchParams params_of(const BenchOptions& options, const Session& session) {
    BenchParams params;
    params.classes = options.scaling && options.classes.empty()
                         ? std::vector{RayClass::primary, RayClass::sun, RayClass::diffuse_bounce}
                         : parse_classes(options.classes);
    params.structure = parse_structure(options.structure);
    params.workload.seed = static_cast<std::uint64_t>(session.options.seed);
    params.workload.paths = options.quick ? std::size_t{1} << 16U : std::size_t{1} << 18U;
    params.workload.emitters = options.quick ? 2 : 4;
    params.effort.budget_ms = options.quick ? 250 : 1500;
    params.effort.brute_force = options.quick ? 4'000'000 : 50'000'000;
    params.effort.is_thorough = !options.quick && !options.scaling;
    if (options.paths > 0) params.workload.paths = options.paths;
    if (options.emitters > 0) params.workload.emitters = options.emitters;
    return params;
}

/// The arguments, or the generated scenes whose sizes are to grow.
std::vector<std::string> arguments_of(const BenchOptions& options) {
    if (!options.scaling) {
        if (options.scenes.empty())
            throw UsageError(
                "a scene is needed: a file, a folder, or a generated one such as city:100000"
            );
        return options.scenes;
    }
    for (const std::string& name : options.scenes)
        if (name.find(':') != std::string::npos || scenes_named(name, {}).front().recipe.empty())
            throw UsageError("--scaling takes names of generated scenes without sizes, such as city"
            );
    const std::vector<std::string> names =
        options.scenes.empty() ? std::vector<std::string>{"city", "forest", "terrain"}
                               : options.scenes;
    const std::size_t usual = options.quick ? 1'000'000 : 10'000'000;
    return series_of(names, options.largest > 0 ? options.largest : usual);
}

std::vector<SceneOptions> scenes_of(const BenchOptions& options) {
    std::vector<SceneOptions> scenes;
    for (const std::string& argument : arguments_of(options))
        for (SceneOptions& scene : scenes_named(argument, options.common))
            scenes.push_back(std::move(scene));
    return scenes;
}

/// File names without their folders and suffixes: rows are about scenes, not about this machine.
std::string short_title(const SceneOptions& scene) {
    return scene.recipe.empty() ? std::filesystem::path(scene.file).stem().string() : scene.recipe;
}

template <class Row>
void append(std::vector<Row>& all, const std::vector<Row>& more) {
    all.insert(all.end(), more.begin(), more.end());
}

void append(SceneBench& all, const SceneBench& one) {
    append(all.rows, one.rows);
    append(all.builds, one.builds);
    append(all.break_even, one.break_even);
    append(all.limits, one.limits);
    append(all.threads, one.threads);
}

/// All scenes, one after the other; their names and hashes go into the provenance.
SceneBench bench_scenes(
    const std::vector<SceneOptions>& scenes,
    const BenchOptions& options,
    const BenchMachine& machine,
    const Session& session,
    Provenance& provenance
) {
    const BenchParams params = params_of(options, session);
    const Progress progress = session.progress();
    SceneBench bench;
    for (const SceneOptions& source : scenes) {
        const Scene scene = open_scene(source, session);
        require_memory(source, scene.triangles.size() * bytes_per_triangle, "measuring");
        const std::string title = short_title(source);
        append(bench, bench_scene(title, scene, params, machine, progress));
        if (options.scaling && &source == &scenes.back())
            append(
                bench.threads,
                bench_threads(title, scene, params.workload, params.effort, machine.build, progress)
            );
        const std::uint64_t hash = content_hash(scene);
        provenance.scene += (provenance.scene.empty() ? "" : ", ") + title;
        provenance.scene_hash = scenes.size() == 1 ? hash : mix_bits(provenance.scene_hash ^ hash);
    }
    bench.growth = growth_of(bench.rows);
    provenance.facts = {
        {"peer", "Embree " + embree_version()},
        {"trace_threads", fmt::format("{}", machine.trace.threads())},
        {"paths", fmt::format("{}", params.workload.paths)},
        {"emitters", fmt::format("{}", params.workload.emitters)},
        {"shadow_ray_offset", fmt::format("{} scene diagonals", params.workload.offset)},
    };
    return bench;
}

std::string chart_caption(const Provenance& provenance) {
    return fmt::format(
        "raywise {}, Embree {}, {}, seed {}",
        provenance.version,
        embree_version(),
        provenance.cpu,
        provenance.seed
    );
}

void run_bench(const BenchOptions& options, const Session& session) {
    if (!has_embree())
        throw UsageError(
            "bench measures beside Embree, which this raywise was built without (libembree-dev)"
        );
    if (!options.chart.empty() && !options.chart.ends_with(".svg"))
        throw UsageError("--chart writes SVG: a name that ends in .svg is needed");
    const std::vector<SceneOptions> scenes = scenes_of(options);
    const Executor build = session.executor();
    const Executor trace(session.options.threads == 0 ? 1 : session.options.threads);
    Provenance provenance = session.provenance();
    const SceneBench bench = bench_scenes(scenes, options, {build, trace}, session, provenance);

    if (!options.chart.empty()) {
        const std::string chart = draw_chart(bench.rows, chart_caption(provenance));
        session.put_files([&] { put(options.chart, chart); });
        session.console.message(options.chart + ": chart written");
    }
    session.put_report(
        report_of(bench, report_format(session.options.format), provenance), session.options.output
    );
    std::size_t wrong = 0;
    for (const BenchRow& row : bench.rows)
        wrong += row.mismatches;
    if (wrong > 0) throw CheckFailed(fmt::format("{} answers differ from the exact oracle", wrong));
}

} // namespace

Command add_bench(CLI::App& root, CommonOptions& options) {
    CLI::App* app = root.add_subcommand(
        "bench", "Measure rays per second beside Embree: same rays, verified answers"
    );
    const auto own = std::make_shared<BenchOptions>();
    app->add_option(
           "scenes,--scenes",
           own->scenes,
           "Scene files, folders of them, or generated scenes such as city:100000"
    )
        ->take_all()
        ->type_name("SCENE");
    app->add_option(
        "--classes",
        own->classes,
        "Ray classes, such as primary,sun; without it all: " +
            fmt::format("{}", fmt::join(class_names(), ", "))
    );
    app->add_option(
        "--structure",
        own->structure,
        "Force what areas are traced through where they may: auto, none, binary_tree, wide_tree, "
        "framed_tree (parallel areas), pencil_grid or inversion (exact areas)"
    );
    app->add_option(
        "--chart", own->chart, "Write a chart (.svg): one bar per scene and class of rays"
    );
    app->add_flag("--quick", own->quick, "Fewer rays, emitters and rounds: seconds per scene");
    app->add_flag(
        "--scaling",
        own->scaling,
        "Growth over generated scenes of 10^4, 10^5, ... triangles, and what threads gain; SCENE: "
        "names such as city, by default city, forest and terrain"
    );
    app->add_option(
           "--largest",
           own->largest,
           "Triangles at which --scaling ends; 0: 10000000, with --quick 1000000"
    )
        ->check(CLI::Range(std::size_t{0}, std::size_t{100'000'000}))
        ->capture_default_str();
    app->add_option("--paths", own->paths, "Paths per scene; 0: 262144, with --quick 65536")
        ->check(CLI::Range(std::size_t{0}, std::size_t{100'000'000}))
        ->capture_default_str();
    app->add_option("--emitters", own->emitters, "Eyes, suns and lamps each; 0: 4, with --quick 2")
        ->check(CLI::Range(0, 64))
        ->capture_default_str();
    app->add_flag(
        "--skip-invalid",
        own->common.skip_invalid,
        "Drop triangles that are not finite, and count them"
    );
    app->add_option(
           "--max-memory",
           own->common.max_memory,
           "Refuse what needs more memory, such as 512M or 4G; 0: no limit"
    )
        ->transform(CLI::AsSizeValue(false))
        ->capture_default_str();
    add_common_options(*app, options, "Write the report to this file");
    return {app, {}, [own](const Session& session) { run_bench(*own, session); }};
}

} // namespace raywise::app
