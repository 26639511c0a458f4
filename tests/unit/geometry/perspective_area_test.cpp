#include <raywise/geometry/perspective_area.hpp>

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

using Relation = PerspectiveView::Relation;

PerspectiveWindow random_window(Rng& rng) {
    PerspectiveWindow window;
    window.eye = random_point(rng, 1);
    window.frame = random_frame(rng);
    window.tan_x = rng.uniform(0.05, 2);
    window.tan_y = rng.uniform(0.05, 2);
    window.near = rng.below(2) == 0 ? 0 : rng.uniform(0.01, 0.6);
    return window;
}

/// A box somewhere around the window's axis, often across the near plane, sometimes around the eye.
Aabb random_box_before(const PerspectiveWindow& window, Rng& rng) {
    const Vec3d along = window.frame.forward * rng.uniform(-0.4, 2);
    return random_box(rng, window.eye + along + random_point(rng, 0.8), 0.8);
}

/// Area of the hull of the projected vertices, cut by the window, over the window's: for boxes in
/// front of the eye.
double hull_share(const Aabb& box, const PerspectiveWindow& window) {
    std::array<Vec2d, 8> shadow;
    for (int i = 0; i < 8; ++i) {
        const Vec3d at = to_frame(window.frame, to_double(box.vertex(i)) - window.eye);
        shadow[static_cast<std::size_t>(i)] = {
            at.x / at.z / window.tan_x, at.y / at.z / window.tan_y
        };
    }
    return area(intersect(convex_hull(shadow), Rectangle{})) / 4;
}

TEST(PerspectiveProjection, RefusesWindowsThatAreNone) {
    EXPECT_THROW(PerspectiveProjection({.tan_x = 0}), Error);
    EXPECT_THROW(PerspectiveProjection({.tan_y = -1}), Error);
    EXPECT_THROW(PerspectiveProjection({.tan_y = HUGE_VAL}), Error);
    EXPECT_THROW(PerspectiveProjection({.near = -1}), Error);
    EXPECT_THROW(PerspectiveProjection({.eye = {0, std::nan(""), 0}}), Error);
}

TEST(PerspectiveProjection, EmptyBrokenPointAndBackwardBoxesAreNeverMet) {
    constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
    const PerspectiveProjection share({});
    EXPECT_EQ(share(Aabb{}), 0);
    EXPECT_EQ(share(Aabb{{0, 0, nan_value}, {1, 1, 1}}), 0);
    EXPECT_EQ(share(Aabb{{0, 0, 2}, {0, 0, 2}}), 0);
    EXPECT_EQ(share(Aabb{{-1, -1, -2}, {1, 1, -1}}), 0);
    EXPECT_EQ(share(Aabb{{5, -1, 1}, {6, 1, 2}}), 0);
    EXPECT_DOUBLE_EQ(share(Aabb{{-1, -1, 2}, {1, 1, 2}}), 0.25);
    EXPECT_DOUBLE_EQ(share(Aabb{{-1, -1, 2}, {1, 1, 9}}), 0.25); // its back is hidden
}

// Thesis: the silhouette from inside is empty, so the root and its ancestors had probability 0.
TEST(PerspectiveProjection, EveryRayMeetsABoxAroundTheEye) {
    const PerspectiveProjection share({});
    EXPECT_EQ(share(Aabb{{-1, -1, -1}, {1, 1, 1}}), 1);
    EXPECT_EQ(share(Aabb{{-1, -1, -1}, {1, 1, 0}}), 1); // the eye is in a face, looking away
    EXPECT_EQ(share(Aabb{{0, 0, 0}, {0, 0, 0}}), 1);    // the eye itself
    const PerspectiveProjection from_near({.near = 0.5});
    EXPECT_DOUBLE_EQ(from_near(Aabb{{-1, -1, -1}, {1, 1, 1}}), 1);
    EXPECT_EQ(from_near(Aabb{{-1, -1, -1}, {1, 1, 0.25F}}), 0); // behind where the rays start
    // Rays that start inside the box at the near plane meet it; no others return.
    EXPECT_DOUBLE_EQ(from_near(Aabb{{-1, -1, -1}, {0, 1, 1}}), 0.5);
}

// Thesis: vertices with w <= 0 were divided anyway.
TEST(PerspectiveProjection, ABoxThatReachesBehindTheEyeShowsOnlyItsFrontPart) {
    const PerspectiveProjection share({});
    // The slab right of x = 1: seen where x / z in [0, 1] beyond x = 1, that is for all x > 0.
    EXPECT_NEAR(share(Aabb{{1, -1e6F, -1e6F}, {1e6F, 1e6F, 1e6F}}), 0.5, 1e-5);
}

TEST(PerspectiveProjection, TheClosedFormOfABoxInTheWindowIsTheHullOfItsVertices) {
    int inside = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        Rng rng(51, i);
        PerspectiveWindow window = random_window(rng);
        window.tan_x = window.tan_y = 2;
        const Vec3d center = window.eye + window.frame.forward * rng.uniform(0.8, 3);
        const Aabb box = random_box(rng, center + random_point(rng, 0.5), 0.5);
        const PerspectiveView view(window);
        if (view.relation(box) != Relation::inside) continue;
        ++inside;
        const double share = view.inside_share(box);
        const auto weigh = [](const ConvexPolygon& piece) { return area(piece) / 4; };
        EXPECT_NEAR(share, hull_share(box, window), 1e-12);
        EXPECT_NEAR(share, view.sum_over_shadow(box, weigh), 1e-12);
    }
    EXPECT_GT(inside, 5000);
}

TEST(PerspectiveProjection, ABoxInFrontButAcrossTheWindowIsTheClippedHull) {
    int across = 0;
    for (std::uint64_t i = 0; i < 10000; ++i) {
        Rng rng(52, i);
        PerspectiveWindow window = random_window(rng);
        window.near = 0;
        const Vec3d center = window.eye + window.frame.forward * rng.uniform(2, 3);
        const Aabb box = random_box(rng, center + random_point(rng, 1), 0.5);
        if (PerspectiveView(window).relation(box) != Relation::across) continue;
        ++across;
        EXPECT_NEAR(PerspectiveProjection(window)(box), hull_share(box, window), 1e-12);
    }
    EXPECT_GT(across, 1000);
}

TEST(PerspectiveProjection, AgreesWithPinholeRays) {
    constexpr int rays = 4000;
    int across = 0;
    for (std::uint64_t i = 0; i < 400; ++i) {
        Rng rng(53, i);
        const PerspectiveWindow window = random_window(rng);
        const Aabb box = random_box_before(window, rng);
        const double share = PerspectiveProjection(window)(box);
        across += PerspectiveView(window).relation(box) == Relation::across ? 1 : 0;
        int hits = 0;
        for (int k = 0; k < rays; ++k) {
            const Vec3d direction = sample_pinhole(window.frame, window.tan_x, window.tan_y, rng);
            hits += meets(box, window.eye, direction, window.near) ? 1 : 0;
        }
        // Five standard deviations of a binomial share; 1e-3 stands in for shares near 0 and 1.
        const double spread = std::sqrt(std::max(share * (1 - share), 1e-3) / rays);
        EXPECT_NEAR(static_cast<double>(hits) / rays, share, 5 * spread) << i;
    }
    EXPECT_GT(across, 100);
}

TEST(PerspectiveProjection, IsMonotoneUpToRounding) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
        Rng rng(54, i);
        const PerspectiveWindow window = random_window(rng);
        const PerspectiveProjection share(window);
        const Aabb inner = random_box_before(window, rng);
        const Aabb outer = unite(inner, to_float(random_point(rng, 2)));
        EXPECT_LE(share(inner), share(outer) + 1e-9);
        EXPECT_GE(share(inner), 0);
        EXPECT_LE(share(outer), 1);
    }
}

TEST(PerspectiveProjection, FromFarAwayItIsTheOrthographicShadow) {
    const Aabb box{{-1, -2, -3}, {1, 2, 3}};
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(55, i);
        constexpr double distance = 1e7;
        const Frame frame = random_frame(rng);
        const double tangent = 5 / distance;
        const PerspectiveProjection share({frame.forward * -distance, frame, tangent, tangent, 0});
        const Vec3d d = abs(frame.forward);
        const double shadow = d.x * 24 + d.y * 12 + d.z * 8;
        EXPECT_NEAR(share(box), shadow / 100, 1e-6);
    }
}

TEST(PerspectiveProjection, TinyAndHugeScalesMeasureAlike) {
    for (std::uint64_t i = 0; i < 500; ++i) {
        Rng rng(56, i);
        PerspectiveWindow window = random_window(rng);
        const Aabb box = random_box_before(window, rng);
        const double share = PerspectiveProjection(window)(box);
        for (const double scale : {0x1p-60, 0x1p50}) { // powers of two scale exactly
            const auto factor = static_cast<float>(scale);
            PerspectiveWindow scaled = window;
            scaled.eye = window.eye * scale;
            scaled.near = window.near * scale;
            EXPECT_EQ(PerspectiveProjection(scaled)({box.lo * factor, box.hi * factor}), share);
        }
    }
}

} // namespace
} // namespace raywise
