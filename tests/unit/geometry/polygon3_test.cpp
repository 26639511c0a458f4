#include <raywise/geometry/polygon3.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/geometry/sampling.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace raywise {
namespace {

const std::vector<Vec3> unit_square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

TEST(PlanarPolygon, RefusesWhatIsNoPlanarConvexPolygon) {
    constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
    const auto refused = [](const std::vector<Vec3>& vertices) {
        EXPECT_THROW((void)PlanarPolygon(vertices), Error);
    };
    refused({});
    refused({{0, 0, 0}, {1, 0, 0}});
    refused({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});                    // no area
    refused({{0, 0, 0}, {1, 0, 0}, {nan_value, 1, 0}});            // not finite
    refused({{0, 0, 0}, {1, 0, 0.01F}, {1, 1, 0}, {0, 1, 0.01F}}); // not planar
    refused({{0, 0, 0}, {1, 0, 0}, {0.2F, 0.2F, 0}, {0, 1, 0}});   // not convex
    refused(
        {{0, 1, 0}, {0.59F, -0.81F, 0}, {-0.95F, 0.31F, 0}, {0.95F, 0.31F, 0}, {-0.59F, -0.81F, 0}}
    ); // a pentagram
    refused(std::vector<Vec3>(17, Vec3{1, 2, 3}));
}

TEST(PlanarPolygon, ToleratesRoundingAtAnyScale) {
    for (const float scale : {1e-15F, 1.0F, 1e15F}) {
        const std::vector<Vec3> almost{
            Vec3{0, 0, 0} * scale,
            Vec3{1, 0, 5e-5F} * scale,
            Vec3{1, 1, 0} * scale,
            Vec3{0, 1, 5e-5F} * scale
        };
        EXPECT_NO_THROW((void)PlanarPolygon(almost));
    }
}

TEST(PlanarPolygon, ACollinearFirstTripleStillHasANormal) {
    const std::vector<Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    const PlanarPolygon polygon(vertices);
    EXPECT_EQ(polygon.normal(), (Vec3d{0, 0, 8}));
    EXPECT_EQ(polygon.area(), 4);
    EXPECT_EQ(intersect({{1, 1, 5}, {0, 0, -1}}, polygon), 5.0F);
}

TEST(RayPolygon, DegenerateRaysMiss) {
    const PlanarPolygon polygon(unit_square);
    constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(intersect({{0.5F, 0.5F, 1}, {0, 0, 0}}, polygon), std::nullopt);
    EXPECT_EQ(intersect({{0.5F, 0.5F, nan_value}, {0, 0, -1}}, polygon), std::nullopt);
    EXPECT_EQ(intersect({{0.5F, 0.5F, 0}, {1, 0, 0}}, polygon), std::nullopt); // in the plane
    EXPECT_EQ(intersect({{0.5F, 0.5F, 1}, {0, 0, -1}, 0, 0.5F}, polygon), std::nullopt);
    EXPECT_EQ(intersect({{0.5F, 0.5F, 1}, {0, 0, -1}, 1.5F, 2}, polygon), std::nullopt);
}

TEST(RayPolygon, EdgesVerticesAndBothEndsOfTheIntervalBelong) {
    const PlanarPolygon polygon(unit_square);
    for (const Vec3& at : {Vec3{0, 0, 0}, Vec3{1, 0.5F, 0}, Vec3{1, 1, 0}, Vec3{0.5F, 0.5F, 0}}) {
        const Vec3 above = at + Vec3{0, 0, 2};
        EXPECT_EQ(intersect({above, {0, 0, -1}, 2, 2}, polygon), 2.0F);
    }
    EXPECT_EQ(intersect({{1.0001F, 0.5F, 2}, {0, 0, -1}}, polygon), std::nullopt);
}

// Thesis: |n . d| < 0.01 was parallel, so rays within 0.57 degrees of a surface never hit it.
TEST(RayPolygon, GrazingRaysHit) {
    const PlanarPolygon polygon(unit_square);
    const auto t = intersect({{0, 0.5F, 0.0005F}, {1, 0, -0.001F}}, polygon);
    ASSERT_TRUE(t.has_value());
    EXPECT_NEAR(*t, 0.5F, 1e-6F);
}

TEST(RayPolygon, ATriangleAgreesWithTheExactTestAwayFromItsEdges) {
    int hits = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        Rng rng(71, i);
        const Triangle triangle = testing::random_triangle(rng, {0, 0, 0}, 1);
        const std::array<Vec3, 3> corners{triangle.v0, triangle.v1, triangle.v2};
        const PlanarPolygon polygon(corners);
        const Vec3d target = testing::random_point(rng, 0.6);
        const Vec3d origin = testing::random_point(rng, 3);
        const Ray ray{to_float(origin), to_float(target - origin)};
        const std::optional<Hit> hit = intersect(ray, triangle, PrimId{0});
        const std::optional<float> t = intersect(ray, polygon);
        const bool near_edge =
            hit && (hit->u < 1e-5F || hit->v < 1e-5F || hit->u + hit->v > 1 - 1e-5F);
        if (near_edge) continue;
        if (hit) {
            ++hits;
            ASSERT_TRUE(t.has_value());
            EXPECT_NEAR(*t, hit->t, 1e-6F * hit->t);
        } else {
            EXPECT_FALSE(t.has_value()) << i;
        }
    }
    EXPECT_GT(hits, 2000);
}

TEST(RayPolygon, APolygonIsHitExactlyWhereItsFanIs) {
    int hits = 0;
    for (std::uint64_t i = 0; i < 5000; ++i) {
        Rng rng(72, i);
        const Frame frame = testing::random_frame(rng);
        const Vec3d center = testing::random_point(rng, 1);
        const std::size_t count = 3 + rng.below(14);
        std::vector<Vec3> vertices;
        for (std::size_t k = 0; k < count; ++k) {
            const double angle = 6.283185307 * static_cast<double>(k) / static_cast<double>(count);
            const Vec3d at = center + frame.right * std::cos(angle) + frame.up * std::sin(angle);
            vertices.push_back(to_float(at));
        }
        const PlanarPolygon polygon(vertices);
        const Vec3d origin = testing::random_point(rng, 3);
        const Vec2d on_disk = sample_disk(1.2, rng);
        const Vec3d target = center + frame.right * on_disk.x + frame.up * on_disk.y;
        const Ray ray{to_float(origin), to_float(target - origin)};
        bool in_fan = false;
        for (std::size_t k = 1; k + 1 < count; ++k) {
            const Triangle part{vertices[0], vertices[k], vertices[k + 1]};
            in_fan = in_fan || intersect(ray, part, PrimId{0}).has_value();
        }
        hits += in_fan ? 1 : 0;
        EXPECT_EQ(intersect(ray, polygon).has_value(), in_fan) << i;
    }
    EXPECT_GT(hits, 1000);
}

} // namespace
} // namespace raywise
