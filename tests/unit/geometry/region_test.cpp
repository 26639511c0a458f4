#include <raywise/geometry/region.hpp>

#include "support/exact_oracle.hpp"
#include "support/exact_polytope.hpp"
#include "support/random_geometry.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <variant>

namespace raywise {
namespace {

using testing::random_box;
using testing::random_frustum;
using testing::random_obb;
using testing::random_point;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

const Aabb unit_box{{-1, -1, -1}, {1, 1, 1}};
const Obb unit_obb{{0, 0, 0}, {}, {1, 1, 1}};
const Frustum pyramid{{0, 0, 0}, {}, 1, 1, 0, 2};

Region random_region(Rng& rng) {
    switch (rng.below(3)) {
    case 0: {
        const Vec3d center = random_point(rng, 1);
        return random_box(rng, center, 1);
    }
    case 1:
        return random_obb(rng, 1, 1);
    default:
        return random_frustum(rng, 1);
    }
}

oracle::Polytope polytope(const Region& region) {
    return std::visit([](const auto& kind) { return oracle::polytope(kind); }, region);
}

std::array<Vec3d, 8> vertices(const Region& region) {
    std::array<Vec3d, 8> all;
    for (int i = 0; i < 8; ++i) {
        Vec3d& at = all[static_cast<std::size_t>(i)];
        if (const auto* box = std::get_if<Aabb>(&region)) at = to_double(box->vertex(i));
        if (const auto* obb = std::get_if<Obb>(&region)) at = vertex(*obb, i);
        if (const auto* frustum = std::get_if<Frustum>(&region)) at = vertex(*frustum, i);
    }
    return all;
}

/// A convex combination of the vertices.
Vec3d random_inside(const Region& region, Rng& rng) {
    Vec3d sum;
    double total = 0;
    for (const Vec3d& at : vertices(region)) {
        const double weight = -std::log(1 - rng.uniform_double());
        sum = sum + at * weight;
        total += weight;
    }
    const Vec3d point = sum / total;
    // A box is exact: on a flat one the rounded sum must be put back into the plane.
    if (const auto* box = std::get_if<Aabb>(&region))
        return max(min(point, to_double(box->hi)), to_double(box->lo));
    return point;
}

TEST(Region, TheEmptyBoxContainsAndOverlapsNothingAndIsInNothing) {
    const Region empty = Aabb{};
    EXPECT_FALSE(contains(empty, Vec3d{0, 0, 0}));
    EXPECT_FALSE(contains(empty, unit_box));
    EXPECT_FALSE(overlaps(empty, unit_box));
    EXPECT_EQ(volume(empty), 0);
    EXPECT_EQ(diameter(empty), 0);
    for (const Region& region : {Region{unit_box}, Region{unit_obb}, Region{pyramid}}) {
        EXPECT_FALSE(contains(region, Aabb{}));
        EXPECT_FALSE(overlaps(region, Aabb{}));
    }
}

TEST(Region, NaNIsNowhere) {
    for (const Region& region : {Region{unit_box}, Region{unit_obb}, Region{pyramid}})
        for (int axis = 0; axis < 3; ++axis) {
            Vec3d point{0, 0, 1};
            EXPECT_TRUE(contains(region, point));
            point[axis] = nan_value;
            EXPECT_FALSE(contains(region, point));
        }
}

TEST(Region, BoundariesBelongAndTheNextFloatDoesNot) {
    const float next = std::nextafter(1.0F, 2.0F);
    EXPECT_TRUE(contains(Region{unit_box}, Vec3d{1, -1, 1}));
    EXPECT_FALSE(contains(Region{unit_box}, to_double({next, 0, 0})));
    EXPECT_TRUE(contains(Region{unit_obb}, Vec3d{1, -1, 1}));
    EXPECT_FALSE(contains(Region{unit_obb}, to_double({next, 0, 0})));
    EXPECT_TRUE(contains(Region{pyramid}, Vec3d{0, 0, 0})); // the apex
    EXPECT_TRUE(contains(Region{pyramid}, Vec3d{2, -2, 2}));
    EXPECT_FALSE(contains(Region{pyramid}, Vec3d{0, 0, -1e-6}));
    EXPECT_FALSE(contains(Region{pyramid}, to_double({next, 0, 1})));
}

// Thesis: the frustum version tested the frustum's own vertices and was practically always false.
TEST(Region, AFrustumContainsASmallBoxAndNotOneThatSticksOut) {
    EXPECT_TRUE(contains(Region{pyramid}, Aabb{{-0.5F, -0.5F, 1}, {0.5F, 0.5F, 1.5F}}));
    EXPECT_FALSE(contains(Region{pyramid}, Aabb{{-0.5F, -0.5F, 0.4F}, {0.5F, 0.5F, 1.5F}}));
    EXPECT_FALSE(contains(Region{pyramid}, Aabb{{-9, -9, -9}, {9, 9, 9}}));
}

TEST(Region, ContainmentAgreesWithTheExactHalfSpaces) {
    int inside = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        Rng rng(21, i);
        const Region region = random_region(rng);
        const Vec3 point = to_float(random_point(rng, 1.5));
        const oracle::Rational3 at = oracle::exact(point);
        bool exact = true;
        for (const oracle::HalfSpace& half : polytope(region).half_spaces)
            exact = exact && oracle::dot(half.normal, at) + half.offset >= 0;
        inside += exact ? 1 : 0;
        EXPECT_EQ(contains(region, to_double(point)), exact);
    }
    EXPECT_GT(inside, 100);
}

TEST(Region, WhatIsInTheHullOfTheVerticesIsContainedInBoundsAndInTheInflatedRegion) {
    for (std::uint64_t i = 0; i < 5000; ++i) {
        Rng rng(22, i);
        const Region region = random_region(rng);
        for (const Vec3d& corner : vertices(region)) {
            EXPECT_TRUE(contains(region, corner));
            EXPECT_TRUE(contains(bounds(region), corner));
        }
        const Vec3d inside = random_inside(region, rng);
        EXPECT_TRUE(contains(region, inside));
        const double margin = std::pow(10, rng.uniform(-9, 1));
        const Vec3d near_by = inside + sample_sphere(rng) * (margin * rng.uniform_double());
        EXPECT_TRUE(contains(inflated(region, margin), near_by));
    }
}

TEST(Region, InflatingMovesEveryCornerInwardOfTheResultByTheMargin) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(23, i);
        const Region region = random_region(rng);
        const double margin = rng.uniform(0.001, 0.5);
        const Region grown = inflated(region, margin);
        EXPECT_EQ(grown.index(), region.index());
        for (const Vec3d& corner : vertices(region))
            for (int k = 0; k < 8; ++k)
                EXPECT_TRUE(contains(grown, corner + sample_sphere(rng) * margin));
    }
    EXPECT_THROW((void)inflated(unit_box, -1), Error);
    EXPECT_THROW((void)inflated(unit_box, nan_value), Error);
    EXPECT_EQ(std::get<Aabb>(inflated(unit_box, 0)), unit_box);
}

TEST(Region, BoundsAreTightWhereCoordinatesAreExact) {
    EXPECT_EQ(bounds(Region{unit_box}), unit_box);
    EXPECT_EQ(bounds(Region{unit_obb}), unit_box);
    EXPECT_EQ(bounds(Region{pyramid}), (Aabb{{-2, -2, 0}, {2, 2, 2}}));
}

TEST(Region, BoundsExceedTheVerticesByTwoFloatsAtMost) {
    for (std::uint64_t i = 0; i < 3000; ++i) {
        Rng rng(24, i);
        const Region region = random_region(rng);
        Vec3d lo{HUGE_VAL, HUGE_VAL, HUGE_VAL};
        Vec3d hi = -lo;
        for (const Vec3d& corner : vertices(region)) {
            lo = min(lo, corner);
            hi = max(hi, corner);
        }
        const Aabb box = bounds(region);
        for (int axis = 0; axis < 3; ++axis) {
            const auto two_steps = [](double x, float to) {
                return std::nextafter(std::nextafter(static_cast<float>(x), to), to);
            };
            EXPECT_GE(box.lo[axis], two_steps(lo[axis], -infinity));
            EXPECT_LE(box.hi[axis], two_steps(hi[axis], infinity));
        }
    }
}

TEST(Region, RaysLeaveThroughTheNearestFaceAheadAndNeverWhenNoneIsAhead) {
    EXPECT_NEAR(exit_parameter(unit_box, {{0, 0, 0}, {0, 0, 2}}), 0.5, 1e-6);
    EXPECT_NEAR(exit_parameter(unit_obb, {{0, 0, 0}, {4, 1, 2}}), 0.25, 1e-6);
    EXPECT_NEAR(exit_parameter(pyramid, {{0, 0, 1}, {0, 0, 1}}), 1, 1e-6);
    EXPECT_NEAR(exit_parameter(pyramid, {{0, 0, 1}, {1, 0, 0}}), 1, 1e-6);
    EXPECT_NEAR(exit_parameter(pyramid, {{0, 0, 1}, {0, 0, -1}}), 1, 1e-6); // through the apex
    EXPECT_EQ(exit_parameter(unit_box, {{1, 0, 0}, {1, 0, 0}}), 0);
    EXPECT_GE(exit_parameter(unit_obb, {{1, 0, 0}, {1, 0, 0}}), 0);
    constexpr float most = std::numeric_limits<float>::max();
    const Aabb everything{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
    EXPECT_EQ(exit_parameter(everything, {{0, 0, 0}, {1, 2, 3}}), infinity);
    EXPECT_LE(exit_parameter(unit_box, {{0, 0, 0}, {1e-44F, 0, 0}}), most);
}

/// The exact parameter at which the ray leaves the polytope; nullopt when it never does.
std::optional<mpq_class> exact_exit(const oracle::Polytope& body, const Ray& ray) {
    std::optional<mpq_class> exit;
    const oracle::Rational3 origin = oracle::exact(ray.origin);
    const oracle::Rational3 direction = oracle::exact(ray.direction);
    for (const oracle::HalfSpace& half : body.half_spaces) {
        const mpq_class rate = oracle::dot(half.normal, direction);
        if (rate >= 0) continue;
        const mpq_class value = oracle::dot(half.normal, origin) + half.offset;
        const mpq_class at = std::max(mpq_class(0), mpq_class(value / -rate));
        if (!exit || at < *exit) exit = at;
    }
    return exit;
}

TEST(Region, TheExitIsNeverPastTheExactOneAndHardlyBeforeIt) {
    for (std::uint64_t i = 0; i < 4000; ++i) {
        Rng rng(25, i);
        const Region region = random_region(rng);
        const double length = std::pow(10, rng.uniform(-6, 6));
        const Ray ray{to_float(random_inside(region, rng)), to_float(sample_sphere(rng) * length)};
        if (!contains(region, to_double(ray.origin))) continue; // rounded out of the set
        const std::optional<mpq_class> exact = exact_exit(polytope(region), ray);
        ASSERT_TRUE(exact.has_value());
        const float exit = exit_parameter(region, ray);
        EXPECT_GE(exit, 0);
        EXPECT_LE(mpq_class(static_cast<double>(exit)), *exact);
        EXPECT_GE(static_cast<double>(exit), exact->get_d() * (1 - 1e-6) - 1e-12 / length);
    }
}

TEST(Region, AnExactHitPastTheExitNeverRoundsToBeforeIt) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(26, i);
        const Region region = random_region(rng);
        const Ray ray{to_float(random_inside(region, rng)), to_float(sample_sphere(rng))};
        if (!contains(region, to_double(ray.origin))) continue;
        const std::optional<mpq_class> exact = exact_exit(polytope(region), ray);
        EXPECT_GE(oracle::nearest_float(*exact), exit_parameter(region, ray));
    }
}

TEST(Region, VolumeAgreesWithMonteCarloAndDiameterWithAllPairsOfVertices) {
    for (std::uint64_t i = 0; i < 60; ++i) {
        Rng rng(27, i);
        const Region region = random_region(rng);
        const std::array<Vec3d, 8> corners = vertices(region);
        double longest = 0;
        for (const Vec3d& p : corners)
            for (const Vec3d& q : corners)
                longest = std::max(longest, length(p - q));
        EXPECT_NEAR(diameter(region), longest, 1e-12 * longest);

        const Aabb box = bounds(region);
        const Vec3d size = to_double(box.size());
        constexpr int samples = 4000;
        int inside = 0;
        for (int k = 0; k < samples; ++k)
            inside += contains(region, to_double(sample_box(box, rng))) ? 1 : 0;
        const double share = volume(region) / (size.x * size.y * size.z);
        if (!(share > 0)) continue; // flat
        // Five standard deviations of a binomial share.
        const double spread = std::sqrt(std::max(share * (1 - share), 1e-3) / samples);
        EXPECT_NEAR(static_cast<double>(inside) / samples, share, 5 * spread);
    }
}

TEST(Region, ARegionContainsABoxOnlyIfItOverlapsItAndBothFollowItsKind) {
    int contained = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        Rng rng(28, i);
        const Region region = random_region(rng);
        const Aabb box = random_box(rng, random_inside(region, rng), 0.2);
        const Triangle diagonal{box.vertex(0), box.vertex(3), box.vertex(6)};
        EXPECT_TRUE(!contains(region, box) || overlaps(region, box));
        EXPECT_TRUE(!overlaps(region, diagonal) || overlaps(region, box));
        if (!contains(region, box)) continue;
        ++contained;
        EXPECT_TRUE(contains(region, to_double(sample_box(box, rng))));
        EXPECT_TRUE(overlaps(region, diagonal));
    }
    EXPECT_GT(contained, 300);
}

} // namespace
} // namespace raywise
