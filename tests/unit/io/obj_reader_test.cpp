// OBJ: the accepted, the refused with its line, and concave polygons by their area.
#include "refusals.hpp"
#include "scratch_folder.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/io/load_scene.hpp>
#include <raywise/io/save_scene.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

namespace raywise {
namespace {

using testing::HasSubstr;
using testing_io::refusal_of;
using testing_io::ScratchFolder;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

class ObjReader : public testing::Test {
protected:
    Scene read(const std::string& text, const LoadOptions& options = {}) {
        return load_scene(folder_.write("scene.obj", text), options, report_);
    }

    std::string refusal(const std::string& text, const LoadOptions& options = {}) {
        return refusal_of([&] { (void)read(text, options); }).value_or("accepted");
    }

    ScratchFolder folder_;
    LoadReport report_;
};

TEST_F(ObjReader, TakesEveryFormOfIndexAndLine) {
    for (const std::string face :
         {"f 1 2 3",
          "f -3 -2 -1",
          "f +1 2 3",
          " \tf 1\t2 3 \t",
          "f 1 2 3 # end",
          "f 1/1 2/1/1 3//1",
          "f 1 2 \\\n 3",
          "f 1 2 \\\r\n3\r"}) {
        const Scene scene = read(three + "vt 0.5\nvn 0 0 1\n" + face + "\n");
        EXPECT_EQ(scene.triangles, (Triangles{{0, 1, 2}})) << face;
    }
    EXPECT_EQ(
        read("# crlf\r\nv 0 0 0\r\nv 1 0 0 1\r\nv 0 1 0 1 1 1\r\nf 1 2 3").vertices.size(), 3U
    );
    EXPECT_EQ(
        read(three + "mtllib a.mtl\nusemtl b\ns off\nl 1 2\np 1\nf 1 2 3\n").triangles.size(), 1U
    );
    EXPECT_EQ(report_.ignored, 2U);
}

TEST_F(ObjReader, KeepsGroupsOfObjectsWithTriangles) {
    const Scene scene =
        read(three + "f 1 2 3\no a b \ng empty\no c\nf 1 3 2\nf 3 2 1\ng\nf 2 1 3\n");
    EXPECT_EQ(scene.groups, (std::vector<Group>{{"c", 1, 2}}));
}

TEST_F(ObjReader, RefusesWhatIsMalformedWithItsLine) {
    for (const std::string bad : {"f 1 2 4",    "f 1 2 0",
                                  "f 1 2 -4",   "f 1 2",
                                  "f 1 1 2",    "f 1 2 1 2",
                                  "f",          "f a b c",
                                  "f 1 2 3.0",  "f 1/ 2 3",
                                  "f 1/1 2 3",  "f 1//1 2 3",
                                  "f 1/2/ 2 3", "f 1 2 3 99999999999999999999",
                                  "v 0 0",      "v 0 0 0 0 0",
                                  "v 0 0 x",    "v 0 0 1,5",
                                  "v 0 0 0x1",  "v 0 0 1e",
                                  "v 0 0 nan",  "v 0 0 nan(1)",
                                  "v 0 0 -inf", "v 0 0 1e39",
                                  "v 0 0 1e-",  "v 0 0 +-1",
                                  "v 0 0 1e20", "vt",
                                  "vn 0 0",     "l",
                                  "p 9",        "curv 0 1 2",
                                  "v\r0 0 0",   "v 0 0 0\r\r",
                                  "x"})
        EXPECT_THAT(refusal(three + bad + "\n"), HasSubstr(":4: ")) << bad;
    // A vertex that comes later is not there yet.
    EXPECT_THAT(
        refusal("v 0 0 0\nv 1 0 0\nf 1 2 3\nv 0 1 0\n"),
        HasSubstr(":3: face refers to vertex 3 of 2")
    );
    EXPECT_THAT(refusal(three + "f 1 2 3\\"), HasSubstr(":4: "));
    EXPECT_THAT(refusal("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r"), HasSubstr(":1: "));
    EXPECT_THAT(refusal(std::string("v 0 0 0\0\n", 9)), HasSubstr(":1: "));
    EXPECT_THAT(refusal(three), HasSubstr("no triangles"));
    EXPECT_THAT(refusal("\n# nothing\n"), HasSubstr("no triangles"));
    EXPECT_THAT(refusal("\x89PNG\r\n\x1a\n"), HasSubstr(":1: "));
    EXPECT_THAT(
        refusal(
            three + "f" +
            [] {
                std::string s;
                for (int i = 0; i < 5000; ++i)
                    s += " 1 2 3";
                return s;
            }()
        ),
        HasSubstr("4096 corners")
    );
}

TEST_F(ObjReader, RoundsNumbersToTheNearestFloat) {
    const Scene scene = read("v 0.1 1e-60 -1e-400\nv 16777217 .5 5.\nv 3.4e-45 1E1 -0\nf 1 2 3\n");
    EXPECT_EQ(scene.vertices[0], (Vec3{0.1F, 0, 0}));
    EXPECT_TRUE(std::signbit(scene.vertices[0].z));
    EXPECT_EQ(scene.vertices[1], (Vec3{16777216, 0.5F, 5}));
    EXPECT_EQ(scene.vertices[2].x, 0x1p-148F);
}

TEST_F(ObjReader, RefusesBeforeItAllocatesMoreThanAllowed) {
    const std::string text = three + "f 1 2 3\n";
    EXPECT_EQ(refusal(text, {.max_bytes = 1000}), "accepted");
    EXPECT_THAT(refusal(text, {.max_bytes = text.size() + 40}), HasSubstr("memory limit"));
    EXPECT_THAT(refusal(text, {.max_bytes = 8}), HasSubstr("memory limit"));
    try {
        (void)read(text, {.max_bytes = 8});
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::limit);
    }
}

/// The polygon in the plane through three axes' directions; as OBJ.
std::string polygon(const std::vector<Vec2d>& outline, int axis, bool is_reversed) {
    std::string text;
    std::string face = "f";
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec2d p = outline[i];
        const std::array<double, 3> xyz = axis == 0   ? std::array<double, 3>{0.5 * p.x, p.x, p.y}
                                          : axis == 1 ? std::array<double, 3>{p.y, 0.25 * p.y, p.x}
                                                      : std::array<double, 3>{p.x, p.y, 7};
        text.append("v");
        for (const double value : xyz)
            text.append(" ").append(std::to_string(value));
        text.append("\n");
        face.append(" ").append(std::to_string(is_reversed ? outline.size() - i : i + 1));
    }
    return text + face + "\n";
}

Vec3d vector_area(const Triangle& triangle) {
    const Vec3d a = to_double(triangle.v0);
    return cross(to_double(triangle.v1) - a, to_double(triangle.v2) - a) * 0.5;
}

TEST_F(ObjReader, CoversConcavePolygonsExactlyOnce) {
    // Triangles that all turn like the polygon and whose areas sum to its own cover it once.
    const std::vector<std::vector<Vec2d>> outlines{
        {{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}},         // a notch
        {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {0, 3}}, // on a line
        {{0, 0}, {5, 0}, {5, 5}, {0, 5}, {0, 1}, {1, 1}, {1, 4}, {4, 4}, {4, 1}, {0, 0.5}
        }, // a spiral
        {{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {2, 2}, {2, 4}, {4, 4}, {4, 2}, {2, 2}}, // a hole
    };
    for (const auto& outline : outlines)
        for (const int axis : {0, 1, 2})
            for (const bool is_reversed : {false, true}) {
                const Scene scene = read(polygon(outline, axis, is_reversed));
                ASSERT_EQ(scene.triangles.size(), outline.size() - 2);
                Vec3d whole;
                const auto corner = [&](std::size_t i) {
                    return to_double(scene.vertices[is_reversed ? outline.size() - 1 - i : i]);
                };
                for (std::size_t i = 1; i + 1 < outline.size(); ++i)
                    whole = whole + cross(corner(i) - corner(0), corner(i + 1) - corner(0)) * 0.5;
                double covered = 0;
                for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
                    const Vec3d area = vector_area(scene.view()[to_prim(i)]);
                    EXPECT_GE(dot(area, whole), -1e-9);
                    covered += length(area);
                }
                EXPECT_NEAR(covered, length(whole), 1e-5);
            }
}

TEST_F(ObjReader, CoversRandomStarsExactlyOnce) {
    for (std::uint64_t item = 0; item < 200; ++item) {
        Rng rng(3, item);
        const std::size_t count = 3 + rng.below(60);
        std::vector<Vec2d> outline;
        for (std::size_t i = 0; i < count; ++i) {
            const double turn =
                2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
            const double radius = rng.uniform(1, 10);
            outline.push_back({radius * std::cos(turn), radius * std::sin(turn)});
        }
        const Scene scene = read(polygon(outline, 2, false));
        double whole = 0;
        double covered = 0;
        for (std::size_t i = 0; i < count; ++i)
            whole += cross(outline[i], outline[(i + 1) % count]) / 2;
        for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
            const double area = vector_area(scene.view()[to_prim(i)]).z;
            EXPECT_GE(area, -1e-9);
            covered += area;
        }
        EXPECT_NEAR(covered, whole, 1e-3) << item;
    }
}

TEST_F(ObjReader, CutsPolygonsThatCrossThemselvesInSomeFixedWay) {
    EXPECT_EQ(read(polygon({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 2, false)).triangles.size(), 2U);
    EXPECT_EQ(
        read(polygon({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {1.5, 0}}, 2, false)).triangles.size(), 3U
    );
    std::vector<Vec2d> tangle;
    Rng rng(4);
    for (int i = 0; i < 4000; ++i)
        tangle.push_back({rng.uniform(0, 1), rng.uniform(0, 1)});
    EXPECT_EQ(read(polygon(tangle, 2, false)).triangles.size(), 3998U);
}

TEST_F(ObjReader, SurvivesTruncationAndMutation) {
    const std::string whole =
        "# comment\no one\n" + three +
        "v 1 1 0.5 1 0 0\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/1/1 -1//1 3\ng two\nf 1 2 \\\n 3\nl 1 2\n";
    for (std::size_t size = 0; size < whole.size(); ++size)
        (void)refusal(whole.substr(0, size));
    const std::size_t refused =
        testing_io::refused_mutations(whole, 4000, [&](const std::string& text) {
            validate(read(text));
        });
    EXPECT_GT(refused, 1000U);
    EXPECT_LT(refused, 4000U);
}

TEST_F(ObjReader, ComesBackBitForBitEvenWithRepeatedCorners) {
    Scene scene = generate_random_triangles(300);
    scene.vertices[5] = {-0.0F, 1e-40F, 0x1p60F};
    scene.groups = {{"first", 10, 20}, {"second # \n part\\", 30, 5}};
    const std::filesystem::path path = folder_.path() / "saved.obj";
    save_scene(path, scene);
    const Scene back = load_scene(path);
    EXPECT_EQ(back.vertices, scene.vertices);
    EXPECT_TRUE(std::signbit(back.vertices[5].x));
    EXPECT_EQ(back.triangles, scene.triangles);
    EXPECT_EQ(back.groups[0], scene.groups[0]);
    EXPECT_EQ(back.groups[1].count, 5U);
    scene.triangles[7] = {3, 3, 4};
    scene.triangles[8] = {3, 3, 3};
    save_scene(path, scene);
    EXPECT_EQ(content_hash(load_scene(path)), content_hash(scene));
}

} // namespace
} // namespace raywise
