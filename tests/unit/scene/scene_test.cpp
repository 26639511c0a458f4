// Scenes: validation, hashes and exact degeneracy.
#include <raywise/scene/scene.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/scene/generate.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>

namespace raywise {
namespace {

Scene one_triangle() {
    Scene scene;
    scene.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.triangles = {{0, 1, 2}};
    return scene;
}

std::string refusal(const Scene& scene) {
    try {
        validate(scene);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(Scene, WithoutTrianglesHasEmptyBoundsAndIsValid) {
    const Scene scene;
    EXPECT_TRUE(bounds(scene).is_empty());
    EXPECT_EQ(count_degenerate(scene), 0U);
    EXPECT_EQ(count_duplicates(scene), 0U);
    EXPECT_TRUE(triangle_boxes(scene).empty());
    EXPECT_NO_THROW(validate(scene));
}

TEST(Scene, BoundsIgnoreVerticesThatNoTriangleUses) {
    Scene scene = one_triangle();
    scene.vertices.push_back({100, 100, 100});
    EXPECT_EQ(bounds(scene), (Aabb{{0, 0, 0}, {1, 1, 0}}));
}

TEST(ContentHash, DependsOnCornersInOrderAndOnNothingElse) {
    const Scene scene = one_triangle();
    Scene renamed = scene;
    renamed.name = "other";
    renamed.vertices = {{7, 7, 7}, {0, 1, -0.0F}, {0, 0, 0}, {1, -0.0F, 0}};
    renamed.triangles = {{2, 3, 1}};
    EXPECT_EQ(content_hash(scene), content_hash(renamed));
    Scene turned = scene;
    turned.triangles = {{1, 2, 0}};
    EXPECT_NE(content_hash(scene), content_hash(turned));
    Scene moved = scene;
    moved.vertices[2].y = std::nextafter(1.0F, 2.0F);
    EXPECT_NE(content_hash(scene), content_hash(moved));
    EXPECT_NE(content_hash(scene), content_hash(Scene{}));
}

TEST(ContentHash, SeesEveryBlockOfALargeScene) {
    Scene scene = generate_random_triangles(10'000);
    const std::uint64_t hash = content_hash(scene);
    for (const std::size_t vertex : {0U, 12'287U, 12'288U, 29'999U}) {
        Scene changed = scene;
        changed.vertices[vertex].z += 1;
        EXPECT_NE(content_hash(changed), hash) << vertex;
    }
}

TEST(IsDegenerate, HoldsForPointsLinesAndRepeatedVertices) {
    const float tiny = std::numeric_limits<float>::denorm_min();
    EXPECT_TRUE(is_degenerate({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}));
    EXPECT_TRUE(is_degenerate({{1, 2, 3}, {1, 2, 3}, {4, 5, 6}}));
    EXPECT_TRUE(is_degenerate({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}));
    EXPECT_TRUE(is_degenerate({{0, 0, 0}, {tiny, tiny, tiny}, {3 * tiny, 3 * tiny, 3 * tiny}}));
    EXPECT_TRUE(is_degenerate(
        {{0, 0, 0}, {max_coordinate, max_coordinate, 0}, {-max_coordinate, -max_coordinate, 0}}
    ));
}

TEST(IsDegenerate, SeesAreasThatFloatAndDoubleArithmeticLose) {
    const float tiny = std::numeric_limits<float>::denorm_min();
    // One unit in the last place off the line; a triangle of the smallest floats; sides whose
    // lengths differ by 2^209.
    EXPECT_FALSE(is_degenerate({{0, 0, 0}, {1, 1, 1}, {3, 3, std::nextafter(3.0F, 4.0F)}}));
    EXPECT_FALSE(is_degenerate({{0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}}));
    EXPECT_FALSE(is_degenerate({{0, 0, 0}, {max_coordinate, tiny, 0}, {-max_coordinate, 0, 0}}));
    EXPECT_FALSE(is_degenerate(
        {{max_coordinate, max_coordinate, 0},
         {-max_coordinate, -max_coordinate, 0},
         {max_coordinate / 3, max_coordinate / 3, tiny}}
    ));
}

TEST(CountDuplicates, CountsTheSameCornersInAnyOrderByTheirPlaces) {
    Scene scene;
    scene.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0F, 0, 0}, {0, 0, 1}};
    scene.triangles = {{0, 1, 2}, {0, 1, 4}};
    EXPECT_EQ(count_duplicates(scene), 0U);
    scene.triangles.push_back({2, 1, 0}); // turned over
    scene.triangles.push_back({1, 2, 3}); // through a copy of a vertex, of another sign
    EXPECT_EQ(count_duplicates(scene), 2U);
    scene.triangles.push_back({0, 0, 0});
    EXPECT_EQ(count_duplicates(scene), 2U);
    scene.triangles.push_back({3, 0, 0});
    EXPECT_EQ(count_duplicates(scene), 3U);
}

TEST(IsDegenerate, AgreesWithIntegerArithmeticOnSmallGrids) {
    // Coordinates k * 2^-20 with |k| <= 2^20: the determinants fit 64-bit integers exactly.
    std::size_t degenerate = 0;
    for (std::uint64_t item = 0; item < 20'000; ++item) {
        Rng rng(5, item);
        const int spread = item % 2 == 0 ? 3 : 1 << 20;
        std::array<std::array<std::int64_t, 3>, 3> k{};
        for (auto& vertex : k)
            for (auto& value : vertex)
                value =
                    static_cast<std::int64_t>(rng.below(static_cast<std::uint64_t>(2 * spread + 1))
                    ) -
                    spread;
        if (item % 4 == 1) // on a line: v2 = v1 + m (v1 - v0), one unit off for every other
            for (std::size_t axis = 0; axis < 3; ++axis)
                k[2][axis] = 2 * k[1][axis] - k[0][axis] + (item % 8 == 1 && axis == 2 ? 1 : 0);
        const auto minor = [&](std::size_t a, std::size_t b) {
            return (k[1][a] - k[0][a]) * (k[2][b] - k[0][b]) -
                   (k[1][b] - k[0][b]) * (k[2][a] - k[0][a]);
        };
        const bool expected = minor(0, 1) == 0 && minor(1, 2) == 0 && minor(2, 0) == 0;
        const auto point = [&](std::size_t i) {
            const auto at = [&](std::size_t axis) {
                return static_cast<float>(k[i][axis]) * 0x1p-20F;
            };
            return Vec3{at(0), at(1), at(2)};
        };
        EXPECT_EQ(is_degenerate({point(0), point(1), point(2)}), expected) << item;
        degenerate += expected ? 1U : 0U;
    }
    EXPECT_GT(degenerate, 1000U);
    EXPECT_LT(degenerate, 19'000U);
}

TEST(Validate, NamesTheFirstOffender) {
    const float infinity = std::numeric_limits<float>::infinity();
    const auto changed = [](const std::function<void(Scene&)>& change) {
        Scene scene = one_triangle();
        change(scene);
        return refusal(scene);
    };
    EXPECT_EQ(refusal(one_triangle()), "");
    EXPECT_EQ(
        changed([](Scene& s) { s.triangles[0][1] = 3; }), "triangle 0 refers to vertex 3 of 3"
    );
    for (const float bad :
         {std::nanf(""), infinity, -infinity, std::nextafter(max_coordinate, infinity)})
        EXPECT_THAT(
            changed([&](Scene& s) { s.vertices[2].y = bad; }), testing::StartsWith("vertex 2 ")
        );
    EXPECT_EQ(changed([](Scene& s) { s.vertices[2].y = -max_coordinate; }), "");
    EXPECT_THAT(
        changed([](Scene& s) { s.groups = {{"a", 0, 2}}; }), testing::StartsWith("group 0 ")
    );
    EXPECT_THAT(
        changed([](Scene& s) { s.groups = {{"a", 0, 1}, {"b", 0, 1}}; }),
        testing::StartsWith("group 1 ")
    );
    EXPECT_THAT(
        changed([](Scene& s) { s.groups = {{"a", 0xFFFFFFFFU, 0xFFFFFFFFU}}; }),
        testing::StartsWith("group 0 ")
    );
}

TEST(Validate, ChecksLightsAndCameras) {
    const auto with_light = [](const std::function<void(Light&)>& change) {
        Scene scene = one_triangle();
        scene.lights.resize(1);
        scene.lights[0].kind = LightKind::spot;
        scene.lights[0].cone_rad = 0.5;
        change(scene.lights[0]);
        return refusal(scene);
    };
    EXPECT_EQ(with_light([](Light&) {}), "");
    EXPECT_NE(with_light([](Light& l) { l.cone_rad = 0; }), "");
    EXPECT_NE(with_light([](Light& l) { l.cone_rad = 2; }), "");
    EXPECT_NE(with_light([](Light& l) { l.direction = {}; }), "");
    EXPECT_NE(with_light([](Light& l) { l.position.x = std::nan(""); }), "");
    EXPECT_NE(with_light([](Light& l) { l.range = 0; }), "");
    const auto with_camera = [](const std::function<void(Camera&)>& change) {
        Scene scene = one_triangle();
        scene.cameras.resize(1);
        change(scene.cameras[0]);
        return refusal(scene);
    };
    EXPECT_EQ(with_camera([](Camera&) {}), "");
    EXPECT_NE(with_camera([](Camera& c) { c.fov_x_rad = 3.2; }), "");
    EXPECT_NE(with_camera([](Camera& c) { c.far = c.near; }), "");
    EXPECT_NE(with_camera([](Camera& c) { c.eye.z = std::nan(""); }), "");
    EXPECT_NE(
        with_camera([](Camera& c) {
            c.projection = Projection::orthographic;
            c.half_width = 0;
        }),
        ""
    );
}

} // namespace
} // namespace raywise
