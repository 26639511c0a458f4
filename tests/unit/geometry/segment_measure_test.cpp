#include <raywise/geometry/segment_measure.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/ray_box.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace raywise {
namespace {

using namespace testing;

constexpr Aabb world{{-2, -2, -2}, {2, 2, 2}};

/// Segments and half-lines, a third of them along an axis, some starting on round coordinates.
std::vector<Ray> random_segments(std::size_t count) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(3, i);
        Ray ray;
        ray.origin = to_float(random_point(rng, 2));
        if (rng.below(4) == 0) ray.origin = {1, -1, 0};
        ray.direction = to_float(random_point(rng, 1));
        if (rng.below(3) == 0) {
            ray.direction = {0, -0.0F, 0};
            ray.direction[static_cast<int>(rng.below(3))] = rng.below(2) == 0 ? 1.F : -1.F;
        }
        if (rng.below(2) == 0) ray.t_max = 2 * rng.uniform();
        rays.push_back(ray);
    }
    return rays;
}

std::size_t exact_count(const std::vector<Ray>& rays, const Aabb& box) {
    std::size_t count = 0;
    for (const Ray& ray : rays)
        count += intersect(ray, box).has_value() ? std::size_t{1} : std::size_t{0};
    return count;
}

Aabb inflated(const Aabb& box, float by) {
    return {box.lo - Vec3{by, by, by}, box.hi + Vec3{by, by, by}};
}

TEST(SegmentMeasure, NothingMeetsAnEmptyBox) {
    EXPECT_EQ(SegmentMeasure(random_segments(10), world)(Aabb{}), 0.F);
}

TEST(SegmentMeasure, WithoutRaysItIsTheSurfaceArea) {
    const Ray invalid; // no direction
    const SegmentMeasure measure(std::vector<Ray>{invalid}, world);
    EXPECT_EQ(measure.segment_count(), 0U);
    EXPECT_FLOAT_EQ(measure(world), 1);
    EXPECT_FLOAT_EQ(measure({{0, 0, 0}, {1, 1, 1}}), 1.F / 16);
}

TEST(SegmentMeasure, CountsWhatTheReferenceTestMeetsUpToRounding) {
    const std::vector<Ray> rays = random_segments(203);
    const SegmentMeasure measure(rays, world);
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(5, i);
        const Aabb box = random_box(rng, random_point(rng, 2), 1);
        EXPECT_LE(measure.count(box), exact_count(rays, inflated(box, 1e-5F)));
        EXPECT_GE(measure.count(inflated(box, 1e-5F)), exact_count(rays, box));
    }
}

TEST(SegmentMeasure, IsExactlyMonotone) {
    const SegmentMeasure measure(random_segments(101), world, 0);
    for (std::uint64_t i = 0; i < 5000; ++i) {
        Rng rng(7, i);
        const Aabb inner = random_box(rng, random_point(rng, 2), 1);
        Aabb outer = inner;
        outer.hi[static_cast<int>(rng.below(3))] += rng.uniform();
        outer.lo[static_cast<int>(rng.below(3))] -= rng.uniform() * 1e-6F;
        EXPECT_LE(measure(inner), measure(outer));
    }
}

TEST(SegmentMeasure, NarrowingChangesNothingInside) {
    const SegmentMeasure measure(random_segments(500), world);
    for (std::uint64_t i = 0; i < 500; ++i) {
        Rng rng(9, i);
        const Aabb outer = random_box(rng, random_point(rng, 2), 1);
        const SegmentMeasure narrowed = measure.narrowed(outer);
        EXPECT_LE(narrowed.segment_count(), measure.segment_count());
        const Aabb inner = intersect(random_box(rng, random_point(rng, 2), 1), outer);
        EXPECT_EQ(narrowed(inner), measure(inner));
        EXPECT_EQ(narrowed(outer), measure(outer));
    }
}

TEST(SegmentMeasure, WhatStandsBehindTheEndIsNotMet) {
    Ray ray{{0, 0, 0}, {1, 0, 0}};
    const Aabb behind{{1.5F, -1, -1}, {2, 1, 1}};
    EXPECT_EQ(SegmentMeasure(std::vector{ray}, world, 0)(behind), 1.F);
    ray.t_max = 1;
    EXPECT_EQ(SegmentMeasure(std::vector{ray}, world, 0)(behind), 0.F);
}

TEST(SegmentMeasure, ShrinkageIsTheShareOfUniformLines) {
    const Ray ray{{0, 0, 0}, {1, 0, 0}};
    const SegmentMeasure measure(std::vector{ray}, world, 0.25);
    EXPECT_FLOAT_EQ(measure(world), 1);
    const Aabb unmet{{-2, -2, -2}, {-1, -1, -1}};
    EXPECT_FLOAT_EQ(measure(unmet), 0.25F / 1.25F / 16);
}

TEST(SegmentMeasure, RefusesAShrinkageOutOfRange) {
    const std::vector<Ray> rays = random_segments(3);
    EXPECT_THROW(SegmentMeasure(rays, world, -0.1), Error);
    EXPECT_THROW(SegmentMeasure(rays, world, std::numeric_limits<double>::infinity()), Error);
    EXPECT_THROW(SegmentMeasure(rays, world, std::numeric_limits<double>::quiet_NaN()), Error);
}

} // namespace
} // namespace raywise
