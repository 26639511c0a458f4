#include <raywise/geometry/fixed_polygon.hpp>

#include <raywise/core/rng.hpp>
#include <raywise/geometry/vec.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace raywise {
namespace {

using Polygon = FixedPolygon<Vec3d>;

Polygon triangle(Vec3d a, Vec3d b, Vec3d c) {
    Polygon polygon;
    polygon.push_back(a);
    polygon.push_back(b);
    polygon.push_back(c);
    return polygon;
}

double height(Vec3d p) {
    return p.z;
}

TEST(FixedPolygon, ClippingNothingLeavesNothing) {
    EXPECT_TRUE(clipped(Polygon{}, height).empty());
}

TEST(FixedPolygon, WhatIsAboveStaysAndWhatIsBelowGoes) {
    const Polygon above = triangle({0, 0, 1}, {1, 0, 0}, {0, 1, 2}); // touches the plane
    const Polygon kept = clipped(above, height);
    ASSERT_EQ(kept.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(kept[i], above[i]);
    EXPECT_TRUE(clipped(triangle({0, 0, -1}, {1, 0, -2}, {0, 1, -3}), height).empty());
}

TEST(FixedPolygon, ATouchedCornerOrEdgeRemainsWithoutArea) {
    EXPECT_EQ(clipped(triangle({0, 0, 0}, {1, 0, -2}, {0, 1, -3}), height).size(), 1U);
    EXPECT_EQ(clipped(triangle({0, 0, 0}, {1, 0, 0}, {0, 1, -3}), height).size(), 2U);
}

TEST(FixedPolygon, ACutAddsOneVertexAtMostAndItsEndsLieInThePlane) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(141, i);
        const auto random = [&] {
            const double x = rng.uniform(-1, 1);
            const double y = rng.uniform(-1, 1);
            return Vec3d{x, y, rng.uniform(-1, 1)};
        };
        const Polygon whole = triangle(random(), random(), random());
        const Polygon part = clipped(whole, height);
        EXPECT_LE(part.size(), whole.size() + 1);
        for (const Vec3d& p : part)
            EXPECT_GE(p.z, -0x1p-51); // one rounding of a coordinate below 2
    }
}

TEST(FixedPolygon, NeighborsThatShareAnEdgeCutItAtTheSamePoint) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(142, i);
        const Vec3d a{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0, 1)};
        const Vec3d b{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 0)};
        const Polygon left = clipped(triangle(a, b, {2, 0, -1}), height);
        const Polygon right = clipped(triangle(b, a, {-2, 0, -1}), height);
        bool shared = false;
        for (const Vec3d& p : left)
            for (const Vec3d& q : right)
                shared = shared || (p == q && p != a);
        EXPECT_TRUE(shared);
    }
}

} // namespace
} // namespace raywise
