#include <raywise/geometry/projected_area.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/sampling.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace raywise {
namespace {

using testing::meets;
using testing::random_box;
using testing::random_frame;
using testing::random_point;

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

/// Area of the hull of the vertices, projected along `frame.forward`.
double hull_area(const Aabb& box, const Frame& frame) {
    std::array<Vec2d, 8> shadow;
    for (int i = 0; i < 8; ++i) {
        const Vec3d at = to_frame(frame, to_double(box.vertex(i)));
        shadow[static_cast<std::size_t>(i)] = {at.x, at.y};
    }
    return area(convex_hull(shadow));
}

OrthographicWindow random_window(Rng& rng) {
    const Vec3d center = random_point(rng, 1);
    const Frame frame = random_frame(rng);
    return {center, frame, rng.uniform(0.1, 2), rng.uniform(0.1, 2)};
}

TEST(ProjectedArea, EmptyBrokenPointAndEdgeOnBoxesHaveNoShadow) {
    const Vec3d along_z{0, 0, 1};
    EXPECT_EQ(projected_area(Aabb{}, along_z), 0);
    EXPECT_EQ(projected_area(Aabb{{nan_value, 0, 0}, {1, 1, 1}}, along_z), 0);
    EXPECT_EQ(projected_area(Aabb{{1, 1, 1}, {1, 1, 1}}, along_z), 0);
    EXPECT_EQ(projected_area(Aabb{{0, 0, 0}, {0, 5, 5}}, along_z), 0);
    EXPECT_EQ(projected_area(Aabb{{0, 0, 0}, {2, 3, 0}}, along_z), 6);
}

TEST(ProjectedArea, IsTheAreaOfTheHullOfTheProjectedVertices) {
    for (std::uint64_t i = 0; i < 5000; ++i) {
        Rng rng(41, i);
        const Frame frame = random_frame(rng);
        const Aabb box = random_box(rng, random_point(rng, 1), 2);
        const double shadow = projected_area(box, frame.forward);
        EXPECT_NEAR(shadow, hull_area(box, frame), 1e-13 * (1 + shadow));
    }
}

TEST(ProjectedArea, AveragedOverDirectionsIsAQuarterOfTheSurfaceArea) {
    const Aabb box{{0, 0, 0}, {1, 2, 5}};
    Rng rng(42);
    double sum = 0;
    constexpr int samples = 40000;
    for (int i = 0; i < samples; ++i)
        sum += projected_area(box, sample_sphere(rng));
    const double surface = 2 * static_cast<double>(half_area(box));
    // The shadow varies by less than its maximum, 11: five standard errors at most.
    EXPECT_NEAR(sum / samples, surface / 4, 5 * 11 / std::sqrt(12.0 * samples));
}

TEST(OrthographicProjection, RefusesWindowsWithoutArea) {
    EXPECT_THROW(OrthographicProjection({.half_width = 0}), Error);
    EXPECT_THROW(OrthographicProjection({.half_height = -1}), Error);
    EXPECT_THROW(OrthographicProjection({.half_height = HUGE_VAL}), Error);
}

TEST(OrthographicProjection, BoxesBehindBesideAndEmptyAreNeverMet) {
    const OrthographicProjection share({});
    EXPECT_EQ(share(Aabb{}), 0);
    EXPECT_EQ(share(Aabb{{0, 0, nan_value}, {1, 1, 1}}), 0);
    EXPECT_EQ(share(Aabb{{-1, -1, -2}, {1, 1, -1}}), 0);
    EXPECT_EQ(share(Aabb{{2, -1, 1}, {3, 1, 2}}), 0);
    EXPECT_EQ(share(Aabb{{1, -1, 1}, {3, 1, 2}}), 0); // touches the border: no area
    EXPECT_EQ(share(Aabb{{-9, -9, -9}, {9, 9, 9}}), 1);
    EXPECT_EQ(share(Aabb{{0, 0, 5}, {1, 1, 5}}), 0.25);
    EXPECT_EQ(share(Aabb{{0, 0, -1}, {1, 1, 0}}), 0.25); // touches the window plane
    EXPECT_EQ(share(Aabb{{0, 0, 1}, {7, 1, 5}}), 0.25);  // cut by the border
}

// Thesis: a noon sun had a NaN frame.
TEST(OrthographicProjection, AVerticalWindowMeasuresAsAnyOther) {
    const OrthographicProjection noon({.frame = frame_along({0, -1, 0})});
    EXPECT_NEAR(noon(Aabb{{0, -3, 0}, {1, -2, 1}}), 0.25, 1e-15);
}

TEST(OrthographicProjection, AgreesWithTheRaysOfTheWindow) {
    constexpr int rays = 4000;
    for (std::uint64_t i = 0; i < 300; ++i) {
        Rng rng(43, i);
        const OrthographicWindow window = random_window(rng);
        const Aabb box = random_box(rng, random_point(rng, 1.5), 1);
        const double share = OrthographicProjection(window)(box);
        int hits = 0;
        for (int k = 0; k < rays; ++k) {
            const Vec3d origin = window.center +
                                 window.frame.right * (window.half_width * rng.uniform(-1, 1)) +
                                 window.frame.up * (window.half_height * rng.uniform(-1, 1));
            hits += meets(box, origin, window.frame.forward) ? 1 : 0;
        }
        // Five standard deviations of a binomial share; 1e-3 stands in for shares near 0 and 1.
        const double spread = std::sqrt(std::max(share * (1 - share), 1e-3) / rays);
        EXPECT_NEAR(static_cast<double>(hits) / rays, share, 5 * spread) << i;
    }
}

TEST(OrthographicProjection, TheClosedFormContinuesTheClippedOneAtTheBorder) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(44, i);
        OrthographicWindow window = random_window(rng);
        const Vec3d center = window.center + window.frame.forward * 3.0;
        const Aabb box = random_box(rng, center, 0.5);
        window.half_width = window.half_height = 4; // the whole shadow is inside
        const double whole = OrthographicProjection(window)(box) * 64;
        EXPECT_NEAR(whole, projected_area(box, window.frame.forward), 1e-13);
        // As narrow as the shadow itself, so that rounding decides between the two forms.
        const Vec3d size = to_double(box.size());
        const Vec3d half = (to_double(box.lo) + to_double(box.hi)) * 0.5 - window.center;
        window.half_width =
            std::abs(dot(window.frame.right, half)) + dot(abs(window.frame.right), size) / 2;
        const double cut = OrthographicProjection(window)(box) * 16 * window.half_width;
        EXPECT_NEAR(cut, whole, 1e-12);
    }
}

TEST(OrthographicProjection, IsMonotoneUpToRounding) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
        Rng rng(45, i);
        const OrthographicProjection share(random_window(rng));
        const Aabb inner = random_box(rng, random_point(rng, 1.5), 1);
        const Aabb outer = unite(inner, to_float(random_point(rng, 2)));
        EXPECT_LE(share(inner), share(outer) + 1e-12);
        EXPECT_GE(share(inner), 0);
        EXPECT_LE(share(outer), 1);
    }
}

TEST(OrthographicProjection, TinyAndHugeScalesMeasureAlike) {
    for (std::uint64_t i = 0; i < 500; ++i) {
        Rng rng(46, i);
        const OrthographicWindow window = random_window(rng);
        const Aabb box = random_box(rng, random_point(rng, 1.5), 1);
        const double share = OrthographicProjection(window)(box);
        for (const double scale : {0x1p-60, 0x1p50}) { // powers of two scale exactly
            const auto factor = static_cast<float>(scale);
            OrthographicWindow scaled = window;
            scaled.center = window.center * scale;
            scaled.half_width *= scale;
            scaled.half_height *= scale;
            EXPECT_EQ(OrthographicProjection(scaled)({box.lo * factor, box.hi * factor}), share);
        }
    }
}

} // namespace
} // namespace raywise
