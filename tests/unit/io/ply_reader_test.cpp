// PLY: every encoding says the same scene; what lies is refused at once.
#include "refusals.hpp"
#include "scratch_folder.hpp"

#include <raywise/io/load_scene.hpp>
#include <raywise/io/save_scene.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

namespace raywise {
namespace {

using testing::HasSubstr;
using testing_io::refusal_of;
using testing_io::ScratchFolder;

const std::string ascii_square =
    "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\n"
    "property float x\nproperty double y\nproperty float z\n"
    "property uchar red\nelement face 1\n"
    "property list uchar int vertex_indices\nelement edge 1\n"
    "property int vertex1\nproperty list int short more\nend_header\n"
    "0 0 0 255\n1 0 0 0\n1 1e0 0 7\n-0 +1. .0 0\n4 0 1 2 3\n5 2 -7 8\n";

class PlyReader : public testing::Test {
protected:
    Scene read(const std::string& bytes, const LoadOptions& options = {}) {
        return load_scene(folder_.write("scene.ply", bytes), options, report_);
    }

    std::string refusal(const std::string& bytes) {
        return refusal_of([&] { (void)read(bytes); }).value_or("accepted");
    }

    ScratchFolder folder_;
    LoadReport report_;
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
}

template <class T>
void put(std::string& bytes, T value, bool big) {
    std::string raw(sizeof(T), '\0');
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big == (std::endian::native == std::endian::little)) std::reverse(raw.begin(), raw.end());
    bytes += raw;
}

/// The square of the text above, in binary.
std::string binary_square(bool big) {
    std::string bytes = replaced(
        ascii_square.substr(0, ascii_square.find("end_header\n") + 11),
        "ascii",
        big ? "binary_big_endian" : "binary_little_endian"
    );
    for (const auto& [x, y] : {std::pair{0.0F, 0.0}, {1.0F, 0.0}, {1.0F, 1.0}, {-0.0F, 1.0}}) {
        put(bytes, x, big);
        put(bytes, y, big);
        put(bytes, 0.0F, big);
        put(bytes, std::uint8_t{9}, big);
    }
    put(bytes, std::uint8_t{4}, big);
    for (const std::int32_t index : {0, 1, 2, 3})
        put(bytes, index, big);
    put(bytes, std::int32_t{5}, big);
    put(bytes, std::int32_t{2}, big);
    put(bytes, std::int16_t{-7}, big);
    put(bytes, std::int16_t{8}, big);
    return bytes;
}

TEST_F(PlyReader, EveryEncodingSaysTheSameScene) {
    const Scene square = read(ascii_square);
    EXPECT_EQ(square.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(square.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(square.name, "scene");
    EXPECT_EQ(report_.polygons, 1U);
    std::string crlf;
    for (const char c : ascii_square)
        crlf += c == '\n' ? "\r\n" : std::string(1, c);
    for (const std::string& bytes : {crlf, binary_square(false), binary_square(true)}) {
        const Scene other = read(bytes);
        EXPECT_EQ(other.vertices, square.vertices);
        EXPECT_EQ(other.triangles, square.triangles);
    }
}

TEST_F(PlyReader, LoadsDegenerateTrianglesAndCountsThem) {
    const Scene scene = read(
        replaced(replaced(ascii_square, "4 0 1 2 3\n", "3 0 1 2\n3 0 0 1\n"), "face 1", "face 2")
    );
    EXPECT_EQ(scene.triangles.size(), 2U);
    EXPECT_EQ(report_.degenerate, 1U);
}

TEST_F(PlyReader, RefusesMalformedTextWithItsLine) {
    EXPECT_THAT(
        refusal(replaced(ascii_square, "4 0 1 2 3\n", "4 0 1 2 4\n")),
        HasSubstr(":19: face refers to vertex 4 of 4")
    );
    EXPECT_THAT(refusal(replaced(ascii_square, "4 0 1 2 3\n", "4 0 1 2 -1\n")), HasSubstr(":19: "));
    EXPECT_THAT(
        refusal(replaced(ascii_square, "4 0 1 2 3\n", "2 0 1\n")), HasSubstr("a face of 2 corners")
    );
    EXPECT_THAT(
        refusal(replaced(ascii_square, "4 0 1 2 3\n", "256 0 1 2 3\n")), HasSubstr(":19: ")
    );
    for (const std::string bad :
         {"nan 0 0 0",
          "0 inf 0 0",
          "1e39 0 0 0",
          "1e19 0 0 0",
          "0x1 0 0 0",
          "1,5 0 0 0",
          "0 0 0",
          "0 0 0 0 0",
          "0 0 0 0.5",
          "a 0 0 0",
          "0 0 0 256",
          "\r0 0 0 0",
          "0 0\r0 0",
          "0 0 0 0\r\r"})
        EXPECT_THAT(refusal(replaced(ascii_square, "0 0 0 255", bad)), HasSubstr(":15: ")) << bad;
    EXPECT_THAT(refusal(ascii_square + "1 2 3\n"), HasSubstr("beyond the last element"));
}

TEST_F(PlyReader, RefusesMalformedHeadersWithTheirLine) {
    EXPECT_THAT(refusal(""), HasSubstr("empty"));
    EXPECT_THAT(refusal("ply"), HasSubstr("no end"));
    EXPECT_THAT(refusal("plyx\n"), HasSubstr(":1: not a PLY file"));
    EXPECT_THAT(refusal(std::string("ply\rformat ascii 1.0\rend_header\r")), HasSubstr(":1: "));
    EXPECT_THAT(refusal(replaced(ascii_square, "ascii", "text")), HasSubstr(":2: unknown format"));
    EXPECT_THAT(refusal(replaced(ascii_square, "1.0", "2.0")), HasSubstr(":2: "));
    EXPECT_THAT(
        refusal(replaced(ascii_square, "property float x", "property real x")),
        HasSubstr(":5: unknown type")
    );
    EXPECT_THAT(
        refusal(replaced(ascii_square, "property float x", "property float w")),
        HasSubstr("no property 'x'")
    );
    EXPECT_THAT(
        refusal(replaced(ascii_square, "float z", "float x")),
        HasSubstr(":7: a property name is used twice")
    );
    EXPECT_THAT(refusal(replaced(ascii_square, "list uchar", "list float")), HasSubstr(":10: "));
    EXPECT_THAT(
        refusal(replaced(ascii_square, "vertex_indices", "corners")), HasSubstr("vertex_indices")
    );
    EXPECT_THAT(refusal(replaced(ascii_square, "vertex 4", "vertex -4")), HasSubstr(":4: "));
    EXPECT_THAT(
        refusal(replaced(ascii_square, "vertex 4", "vertex 99999999999999999999")),
        HasSubstr(":4: ")
    );
}

TEST_F(PlyReader, RefusesCountsThatTheFileCannotHold) {
    for (const std::string count : {"5000", "2147483648", "9223372036854775807"}) {
        EXPECT_THAT(
            refusal(replaced(ascii_square, "vertex 4", "vertex " + count)),
            HasSubstr("more than the file can hold")
        );
        EXPECT_THAT(
            refusal(replaced(binary_square(false), "face 1", "face " + count)), HasSubstr("more")
        );
    }
    // A list as long as its count type allows.
    std::string bytes = binary_square(false);
    bytes[bytes.size() - 8] = '\x7F';
    EXPECT_THAT(refusal(bytes), HasSubstr("ends too early"));
}

TEST_F(PlyReader, RefusesASceneWithoutTriangles) {
    EXPECT_THAT(
        refusal(replaced(replaced(ascii_square, "face 1", "face 0"), "4 0 1 2 3\n", "")),
        HasSubstr("no triangles")
    );
}

TEST_F(PlyReader, SkipsInvalidTrianglesOnDemandAndCountsThem) {
    const std::string bytes = replaced(
        replaced(replaced(ascii_square, "0 0 0 255", "nan 0 0 255"), "face 1", "face 2"),
        "4 0 1 2 3\n",
        "4 0 1 2 3\n3 1 2 3\n"
    );
    EXPECT_THAT(refusal(bytes), HasSubstr("not finite"));
    const Scene scene = read(bytes, {.skip_invalid = true});
    EXPECT_EQ(scene.vertices, (std::vector<Vec3>{{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(scene.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
    EXPECT_EQ(report_.dropped, 2U);
    EXPECT_THAT(
        refusal_of([&] {
            (void)read(replaced(ascii_square, "0 0 0 255", "nan 0 0 255"), {.skip_invalid = true});
        }).value_or(""),
        HasSubstr("no triangles but invalid ones")
    );
}

TEST_F(PlyReader, RefusesEveryTruncation) {
    for (const std::string& whole : {ascii_square, binary_square(false), binary_square(true)})
        for (std::size_t size = 0; size < whole.size(); ++size) {
            // The very last line may lack its end.
            const bool is_whole = whole == ascii_square && size + 1 == whole.size();
            EXPECT_EQ(refusal(whole.substr(0, size)) == "accepted", is_whole) << size;
        }
}

TEST_F(PlyReader, SurvivesMutations) {
    for (const std::string& whole : {ascii_square, binary_square(false), binary_square(true)}) {
        const std::size_t refused =
            testing_io::refused_mutations(whole, 2000, [&](const std::string& bytes) {
                validate(read(bytes));
            });
        EXPECT_GT(refused, 500U);
        EXPECT_LT(refused, 2000U); // some changes, as of a color, leave a valid file
    }
}

TEST_F(PlyReader, ComesBackFromBinaryBitForBit) {
    const Scene scene = generate_random_triangles(500);
    save_scene(folder_.path() / "saved.ply", scene);
    const Scene back = load_scene(folder_.path() / "saved.ply");
    EXPECT_EQ(back.vertices, scene.vertices);
    EXPECT_EQ(back.triangles, scene.triangles);
    EXPECT_EQ(folder_.count(), 1U); // no temporary file is left
}

} // namespace
} // namespace raywise
