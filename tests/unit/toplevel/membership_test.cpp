#include <raywise/toplevel/membership.hpp>

#include "support/random_areas.hpp"

#include <raywise/core/error.hpp>
#include <raywise/scene/scene.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

namespace raywise {
namespace {

using test_support::random_soup;
using test_support::soup_of;

/// A point of the triangle.
Vec3d point_in(const Triangle& t, Rng& rng) {
    double u = rng.uniform_double();
    double v = rng.uniform_double();
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    return to_double(t.v0) * (1 - u - v) + to_double(t.v1) * u + to_double(t.v2) * v;
}

TEST(MembersOf, HoldsEveryTriangleWithAPointInTheRegion) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Rng rng(21, seed);
        const Scene scene = random_soup(rng, 100);
        const Region region = test_support::random_region(rng);
        const auto members = members_of(scene.view(), region);
        ASSERT_TRUE(std::is_sorted(members.begin(), members.end()));
        for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
            const Triangle triangle = scene.view()[to_prim(i)];
            const bool is_member = std::binary_search(members.begin(), members.end(), to_prim(i));
            if (is_degenerate(triangle)) {
                ASSERT_FALSE(is_member);
                continue;
            }
            for (int k = 0; k < 50 && !is_member; ++k) {
                ASSERT_FALSE(contains(region, point_in(triangle, rng)))
                    << "seed " << seed << " triangle " << i;
            }
            // And little more: what overlaps no region twice the margin wider is no member.
            const Region wide = inflated(region, 2.1e-4 * diameter(region));
            ASSERT_TRUE(overlaps(wide, triangle) || !is_member);
        }
    }
}

TEST(MembersOf, KeepsTheWallWithoutAVertexInsideThatTheThesisLoses) {
    const Scene scene = soup_of({{{-50, -50, 0}, {50, -50, 0}, {0, 90, 0}}});
    const Region region = Aabb{{-1, -1, -1}, {1, 1, 1}};
    EXPECT_EQ(members_of(scene.view(), region), std::vector{PrimId{0}});
    EXPECT_TRUE(members_of(scene.view(), region, {.rule = Membership::vertices}).empty());
}

TEST(MembersOf, TouchingCountsAndTheMarginIsRelativeToTheRegion) {
    // Diameter of the cube: sqrt(12) = 3.46; margin 1e-4 of it: 3.46e-4.
    const Region region = Aabb{{-1, -1, -1}, {1, 1, 1}};
    const auto wall_at = [](float x) { return Triangle{{x, -5, -5}, {x, 5, -5}, {x, 0, 9}}; };
    const Scene scene = soup_of({wall_at(1), wall_at(1.0003F), wall_at(1.0004F), wall_at(2)});
    EXPECT_EQ(members_of(scene.view(), region), (std::vector{PrimId{0}, PrimId{1}}));
    EXPECT_EQ(
        members_of(scene.view(), region, {.margin = 0.5}),
        (std::vector{PrimId{0}, PrimId{1}, PrimId{2}, PrimId{3}})
    );
}

TEST(MembersOf, ASceneOfNothingOrARegionInTheVoidHasNone) {
    EXPECT_TRUE(members_of(TriangleView{}, Region{Aabb{{0, 0, 0}, {1, 1, 1}}}).empty());
    Rng rng(22);
    const Scene scene = random_soup(rng, 50);
    EXPECT_TRUE(members_of(scene.view(), Region{Aabb{{90, 90, 90}, {91, 91, 91}}}).empty());
    EXPECT_TRUE(members_of(scene.view(), Region{Aabb{}}).empty());
}

TEST(MembersOf, TrianglesWithoutAreaAndWithoutNumbersAreDropped) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Scene scene = soup_of(
        {{{0, 0, 0}, {0.1F, 0.2F, 0.3F}, {0.2F, 0.4F, 0.6F}},
         {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
         {{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}}}
    );
    const Region region = Aabb{{-1, -1, -1}, {1, 1, 1}};
    for (const auto rule : {Membership::overlap, Membership::vertices}) {
        const auto members = members_of(scene.view(), region, {.rule = rule});
        // The first is collinear in decimal, not in binary: it may stay.
        EXPECT_FALSE(std::count(members.begin(), members.end(), PrimId{1}));
        EXPECT_FALSE(std::count(members.begin(), members.end(), PrimId{2}));
    }
}

TEST(MembersOf, DoesNotDependOnTheThreads) {
    Rng rng(23);
    const Scene scene = random_soup(rng, 20'000);
    const Region region = test_support::random_frustum(rng);
    const Executor four(4);
    EXPECT_EQ(members_of(scene.view(), region, {}, four), members_of(scene.view(), region));
}

TEST(MembersOf, RefusesMarginsOutOfRange) {
    const Region region = Aabb{{0, 0, 0}, {1, 1, 1}};
    for (const double margin : {0.0, -1.0, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(static_cast<void>(members_of({}, region, {.margin = margin})), Error);
    }
}

} // namespace
} // namespace raywise
