#include <raywise/geometry/ray_triangle.hpp>

#include "support/exact_oracle.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

namespace raywise {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr Triangle unit{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST(RayTriangle, HitReportsDistanceWeightsAndSide) {
    const auto hit = intersect({{0.25F, 0.5F, 2}, {0, 0, -4}}, unit, PrimId{7});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->t, 0.5F);
    EXPECT_EQ(hit->u, 0.25F);
    EXPECT_EQ(hit->v, 0.5F);
    EXPECT_EQ(hit->prim, PrimId{7});
    EXPECT_TRUE(hit->front);
    const auto back = intersect({{0.25F, 0.5F, -2}, {0, 0, 4}}, unit);
    ASSERT_TRUE(back);
    EXPECT_FALSE(back->front);
    EXPECT_FALSE(intersect({{0.25F, 0.5F, -2}, {0, 0, 4}}, unit, PrimId{0}, FaceMode::front));
    EXPECT_TRUE(intersect({{0.25F, 0.5F, 2}, {0, 0, -4}}, unit, PrimId{0}, FaceMode::front));
}

TEST(RayTriangle, EdgesAndVerticesBelongToIt) {
    for (const Vec3 p :
         {Vec3{0, 0, 1},
          Vec3{1, 0, 1},
          Vec3{0, 1, 1},
          Vec3{0.5F, 0, 1},
          Vec3{0, 0.5F, 1},
          Vec3{0.5F, 0.5F, 1}}) {
        EXPECT_TRUE(intersect({p, {0, 0, -1}}, unit)) << p.x << ' ' << p.y;
        EXPECT_TRUE(intersect({p, {-0.0F, 0, -1}}, unit)) << p.x << ' ' << p.y;
    }
    EXPECT_FALSE(intersect({{0.5F, 0.50000006F, 1}, {0, 0, -1}}, unit));
    EXPECT_FALSE(intersect({{0.5F, -1e-40F, 1}, {0, 0, -1}}, unit));
}

TEST(RayTriangle, ZeroAreaIsNeverHit) {
    const std::array<Triangle, 4> flat{
        Triangle{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
        Triangle{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}},
        Triangle{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}},
        Triangle{{0, 0, 0}, {0.1F, 0.1F, 0.1F}, {0.3F, 0.3F, 0.3F}},
    };
    for (const Triangle& triangle : flat) {
        EXPECT_FALSE(intersect({{0, 0, 1}, {0, 0, -1}}, triangle));
        EXPECT_FALSE(intersect({{0, 0, 0}, {0, 0, -1}}, triangle));
        EXPECT_FALSE(intersect({{0.5F, 0, 1}, {0, 0, -1}}, triangle));
        EXPECT_FALSE(intersect({{-1, 0, 0}, {1, 0, 0}}, triangle));
    }
}

TEST(RayTriangle, RayInThePlaneMisses) {
    EXPECT_FALSE(intersect({{-1, 0.25F, 0}, {1, 0, 0}}, unit));
    EXPECT_FALSE(intersect({{0.25F, 0.25F, 0}, {1, 2, 0}}, unit));
    EXPECT_FALSE(intersect({{-1, 0, 0}, {1, 0, 0}}, unit)); // along an edge
}

TEST(RayTriangle, StartingOnTheTriangleHitsAtZero) {
    for (const float side : {1.0F, -1.0F}) {
        const auto hit = intersect({{0.25F, 0.25F, 0}, {0.3F, 0.1F, side}}, unit);
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->t, 0);
        EXPECT_FALSE(std::signbit(hit->t));
    }
}

TEST(RayTriangle, IntervalIsClosedAfterRounding) {
    const Ray whole{{0.25F, 0.25F, 1}, {0, 0, -3}};
    const auto hit = intersect(whole, unit);
    ASSERT_TRUE(hit);
    const float t = hit->t;
    EXPECT_EQ(t, 1.0F / 3);
    EXPECT_TRUE(intersect({whole.origin, whole.direction, t, t}, unit));
    EXPECT_FALSE(intersect({whole.origin, whole.direction, std::nextafter(t, infinity)}, unit));
    EXPECT_FALSE(intersect({whole.origin, whole.direction, 0, std::nextafter(t, 0.0F)}, unit));
}

TEST(RayTriangle, InvalidRaysAndVerticesAreAMiss) {
    const Vec3 o{0.25F, 0.25F, 1};
    const Vec3 down{0, 0, -1};
    EXPECT_FALSE(intersect({{nan, 0.25F, 1}, down}, unit));
    EXPECT_FALSE(intersect({{infinity, 0.25F, 1}, down}, unit));
    EXPECT_FALSE(intersect({o, {0, -0.0F, 0}}, unit));
    EXPECT_FALSE(intersect({o, {0, 0, -infinity}}, unit));
    EXPECT_FALSE(intersect({o, down, 2, 1}, unit));
    EXPECT_FALSE(intersect({o, down, nan}, unit));
    EXPECT_FALSE(intersect({o, down}, {{0, 0, nan}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_FALSE(intersect({o, down}, {{0, 0, 0}, {infinity, 0, 0}, {0, 1, 0}}));
    const Ray valid{o, down};
    EXPECT_FALSE(ExactKernel(valid)({{0, 0, nan}, {1, 0, 0}, {0, 1, 0}}, PrimId{0}, infinity));
    EXPECT_FALSE(ExactKernel(valid)({{0, 0, 0}, {infinity, 0, 0}, {0, 1, 0}}, PrimId{0}, infinity));
}

TEST(RayTriangle, ExcludedTriangleIsNotHit) {
    Ray ray{{0.25F, 0.25F, 1}, {0, 0, -1}};
    ray.excluded = PrimId{3};
    EXPECT_FALSE(intersect(ray, unit, PrimId{3}));
    EXPECT_TRUE(intersect(ray, unit, PrimId{4}));
    EXPECT_FALSE(ExactKernel(ray)(unit, PrimId{3}, infinity));
    EXPECT_FALSE(FastKernel(ray)(unit, PrimId{3}, infinity));
}

/// Components from ordinary to extreme: few bits, so that lines meet edges and planes exactly; many
/// bits; all magnitudes of the floats.
float wild(Rng& rng, int kind) {
    const float sign = (rng.bits() & 1U) != 0 ? -1.0F : 1.0F;
    switch (kind) {
    case 0:
        return static_cast<float>(rng.below(5)) - 2;
    case 1:
        return sign * rng.uniform();
    case 2:
        return sign * std::ldexp(1 + rng.uniform(), static_cast<int>(rng.below(210)) - 149);
    default: {
        constexpr std::array<float, 8> special{0, -0.0F, 0x1p-149F, -0x1p-126F, 1, -1, 0x1p60F, 3};
        return special[static_cast<std::size_t>(rng.below(special.size()))];
    }
    }
}

Vec3 wild_vec(Rng& rng, int kind) {
    const auto pick = [&] { return kind == 4 ? static_cast<int>(rng.below(4)) : kind; };
    return {wild(rng, pick()), wild(rng, pick()), wild(rng, pick())};
}

struct Case {
    Ray ray;
    Triangle triangle;
};

/// A fifth of the rays aim at a vertex, a fifth near a point of an edge, a fifth start near the
/// plane.
Case wild_case(std::uint64_t i) {
    Rng rng(20240, i);
    const int kind = static_cast<int>(rng.below(5));
    Case c{{wild_vec(rng, kind), wild_vec(rng, kind)}, {}};
    c.triangle = {wild_vec(rng, kind), wild_vec(rng, kind), wild_vec(rng, kind)};
    const Triangle& t = c.triangle;
    switch (rng.below(5)) {
    case 0:
        c.ray.direction = t.v1 - c.ray.origin;
        break;
    case 1:
        c.ray.direction = (t.v0 + (t.v2 - t.v0) * rng.uniform()) - c.ray.origin;
        break;
    case 2:
        c.ray.origin = t.v0 + (t.v1 - t.v0) * rng.uniform();
        break;
    default:
        break;
    }
    return c;
}

TEST(RayTriangle, AgreesWithRationalArithmeticOnWildInput) {
    int hits = 0;
    for (std::uint64_t i = 0; i < 30000; ++i) {
        const Case c = wild_case(i);
        if (!is_valid(c.ray)) continue;
        const auto expected = oracle::intersect(c.ray, c.triangle);
        const auto seen = ExactKernel(c.ray)(c.triangle, PrimId{0}, c.ray.t_max);
        const auto decided = intersect(c.ray, c.triangle);
        ASSERT_EQ(expected.has_value(), seen.has_value()) << "case " << i;
        ASSERT_EQ(expected.has_value(), decided.has_value()) << "case " << i;
        if (!expected) continue;
        ++hits;
        ASSERT_EQ(expected->t, seen->t) << "case " << i;
        ASSERT_EQ(expected->front, seen->front) << "case " << i;
        ASSERT_NEAR(static_cast<double>(expected->u), static_cast<double>(seen->u), 0x1p-22) << i;
        ASSERT_NEAR(static_cast<double>(expected->v), static_cast<double>(seen->v), 0x1p-22) << i;
        ASSERT_EQ(decided->t, seen->t) << "case " << i;
    }
    EXPECT_GT(hits, 2500); // the test would be worthless without
}

TEST(RayTriangle, MidpointsBetweenFloatsRoundToEven) {
    // t = z exactly, with 25 significant bits: direction 2^-24 units, plane at an odd multiple.
    for (std::uint32_t i = 0; i < 64; ++i) {
        const float near = 1 + static_cast<float>(i) * 0x1p-23F;
        const float spacing = 0x1p-24F;
        // plane z = near * 2 + spacing * 2 needs 25 bits; split between origin and vertices.
        const Triangle triangle{{-1, -1, near}, {3, -1, near}, {-1, 3, near}};
        const Ray ray{{0, 0, -spacing}, {0, 0, 1}};
        const auto hit = intersect(ray, triangle);
        ASSERT_TRUE(hit);
        const auto expected =
            static_cast<float>(static_cast<double>(near) + static_cast<double>(spacing));
        EXPECT_EQ(hit->t, expected);
        EXPECT_EQ(hit->t, oracle::intersect(ray, triangle)->t);
    }
}

TEST(RayTriangle, TheLargestDistancesOverflowToAMiss) {
    const float plane = 0x1p60F;
    const Triangle triangle{{-1, -1, plane}, {3, -1, plane}, {-1, 3, plane}};
    EXPECT_TRUE(intersect({{0, 0, 0}, {0, 0, 0x1p-67F}}, triangle));
    EXPECT_FALSE(intersect({{0, 0, 0}, {0, 0, 0x1p-68F}}, triangle));
    EXPECT_FALSE(intersect({{0, 0, 0}, {0, 0, 0x1p-149F}}, triangle));
}

TEST(FastKernel, AgreesWithTheExactOneAwayFromEdges) {
    int hits = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        Rng rng(77, i);
        const Triangle triangle{wild_vec(rng, 1), wild_vec(rng, 1), wild_vec(rng, 1)};
        const Ray ray{wild_vec(rng, 1), wild_vec(rng, 1)};
        const auto exact = intersect(ray, triangle);
        const auto fast = FastKernel(ray)(triangle, PrimId{0}, infinity);
        if (!exact) continue;
        const float least = std::min({exact->u, exact->v, 1 - exact->u - exact->v});
        if (least < 1e-2F || exact->t > 100 || exact->t < 1e-3F) continue;
        ASSERT_TRUE(fast) << i;
        ASSERT_NEAR(
            static_cast<double>(fast->t),
            static_cast<double>(exact->t),
            1e-2 * static_cast<double>(exact->t)
        ) << i;
        ASSERT_EQ(fast->front, exact->front) << i;
        ++hits;
    }
    EXPECT_GT(hits, 200);
}

TEST(FrontFaces, KeepsOnlyTriangleSeenCounterClockwise) {
    const Ray down{{0.25F, 0.25F, 1}, {0, 0, -1}};
    const Ray up{{0.25F, 0.25F, -1}, {0, 0, 1}};
    EXPECT_TRUE(FrontFaces<ExactKernel>(down)(unit, PrimId{0}, infinity));
    EXPECT_FALSE(FrontFaces<ExactKernel>(up)(unit, PrimId{0}, infinity));
    EXPECT_TRUE(FrontFaces<FastKernel>(down)(unit, PrimId{0}, infinity));
    EXPECT_FALSE(FrontFaces<FastKernel>(up)(unit, PrimId{0}, infinity));
}

} // namespace
} // namespace raywise
