#include <raywise/geometry/solid_angle.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/perspective_area.hpp>
#include <raywise/geometry/sampling.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace raywise {
namespace {

using testing::meets;
using testing::random_box;
using testing::random_frame;
using testing::random_point;

constexpr double pi = std::numbers::pi;

double tan_of_half(double fov_deg) {
    return std::tan(fov_deg * pi / 360);
}

/// Integral of `density(x, y)` over a rectangle by the midpoint rule.
template <class Density>
double integrate(const Rectangle& rectangle, const Density& density) {
    constexpr int steps = 600;
    const Vec2d step = (rectangle.hi - rectangle.lo) * (1.0 / steps);
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
            sum +=
                density(rectangle.lo.x + (i + 0.5) * step.x, rectangle.lo.y + (j + 0.5) * step.y);
    return sum * step.x * step.y;
}

double isotropic_density(double x, double y) {
    return std::pow(1 + x * x + y * y, -1.5);
}

double yaw_pitch_density(double x, double y) {
    return 1 / (std::sqrt(1 + x * x) * (1 + x * x + y * y));
}

TEST(SolidAngle, EmptyIsNothingAndAroundTheEyeIsEverything) {
    EXPECT_EQ(solid_angle_sr(Aabb{}, {0, 0, 0}), 0);
    EXPECT_EQ(solid_angle_sr(Aabb{{-1, -1, -1}, {1, 1, 1}}, {0, 0, 0}), 4 * pi);
    EXPECT_EQ(solid_angle_sr(Aabb{{-1, -1, -1}, {1, 1, 1}}, {1, 1, 1}), 4 * pi);
    EXPECT_EQ(solid_angle_sr(Aabb{{1, 1, 1}, {1, 1, 1}}, {0, 0, 0}), 0);
    EXPECT_EQ(solid_angle_sr(Aabb{{1, 0, 0}, {2, 1, 0}}, {0, 0, 0}), 0); // flat, edge on
}

TEST(SolidAngle, AFaceOfACubeAroundTheEyeIsASixthOfAllDirections) {
    EXPECT_NEAR(solid_angle_sr(Aabb{{-1, -1, 1}, {1, 1, 1}}, {0, 0, 0}), 4 * pi / 6, 1e-14);
    EXPECT_NEAR(solid_angle_sr(Aabb{{-1, -1, 1}, {1, 1, 9}}, {0, 0, 0}), 4 * pi / 6, 1e-14);
    EXPECT_NEAR(window_solid_angle_sr(1, 1), 4 * pi / 6, 1e-14);
}

TEST(SolidAngle, CloseToAWideBoxItIsNearlyAHalfSpace) {
    const Aabb ground{{-1e6F, -1, -1e6F}, {1e6F, 0, 1e6F}};
    EXPECT_NEAR(solid_angle_sr(ground, {0, 1, 0}), 2 * pi, 1e-5);
    EXPECT_NEAR(solid_angle_sr(ground, {0, 1e-3, 0}), 2 * pi, 1e-8);
}

TEST(SolidAngle, OfATinyFarBoxIsItsShadowOverTheSquaredDistance) {
    for (std::uint64_t i = 0; i < 500; ++i) {
        Rng rng(91, i);
        const Aabb box = random_box(rng, {0, 0, 0}, 1);
        const Vec3d toward = sample_sphere(rng);
        for (const double distance : {1e4, 1e7}) {
            const Vec3d s = to_double(box.size());
            const Vec3d d = abs(toward);
            const double shadow = d.x * s.y * s.z + d.y * s.x * s.z + d.z * s.x * s.y;
            const double expected = shadow / (distance * distance);
            const Vec3d middle = (to_double(box.lo) + to_double(box.hi)) * 0.5;
            const double actual = solid_angle_sr(box, middle + toward * distance);
            EXPECT_NEAR(actual, expected, 5 / distance * expected + 1e-4 / (distance * distance));
        }
    }
}

TEST(SolidAngle, AgreesWithRaysInAllDirections) {
    constexpr int rays = 4000;
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(92, i);
        const Vec3d eye = random_point(rng, 1.5);
        const Aabb box = random_box(rng, random_point(rng, 1), 1);
        const double share = solid_angle_sr(box, eye) / (4 * pi);
        int hits = 0;
        for (int k = 0; k < rays; ++k)
            hits += meets(box, eye, sample_sphere(rng)) ? 1 : 0;
        // Five standard deviations of a binomial share; 1e-3 stands in for shares near 0 and 1.
        const double spread = std::sqrt(std::max(share * (1 - share), 1e-3) / rays);
        EXPECT_NEAR(static_cast<double>(hits) / rays, share, 5 * spread) << i;
    }
}

TEST(SolidAngle, OfAWindowIsThatOfItsPolygonAndTheIntegralOfItsDensity) {
    for (const double fov_x : {1e-3, 10.0, 70.0, 130.0})
        for (const double fov_y : {5.0, 50.0, 150.0}) {
            const double x = tan_of_half(fov_x);
            const double y = tan_of_half(fov_y);
            const Rectangle window{{-x, -y}, {x, y}};
            const double whole = window_solid_angle_sr(x, y);
            EXPECT_NEAR(polygon_solid_angle_sr(to_polygon(window)), whole, 1e-12 * (1 + whole));
            EXPECT_NEAR(integrate(window, isotropic_density), whole, 1e-4 * whole);
        }
}

TEST(YawPitch, OfTheSquareCapIsTheRectangleOfItsAngles) {
    for (const double fov_x : {1.0, 45.0, 90.0, 150.0, 175.0})
        for (const double fov_y : {1.0, 60.0, 120.0, 175.0}) {
            const double x = tan_of_half(fov_x);
            // Everything up to the steepest emitted ray, cut at the pitch limit.
            const double y = tan_of_half(fov_y) * std::hypot(1.0, x) * 1.5;
            const double half_yaw = fov_x * pi / 360;
            const double half_pitch = fov_y * pi / 360;
            const double whole = polygon_yaw_pitch_rad2(to_polygon({{-x, -y}, {x, y}}), half_pitch);
            EXPECT_NEAR(whole, 4 * half_yaw * half_pitch, 4e-9);
        }
}

TEST(YawPitch, OfAPolygonIsTheIntegralOfItsDensity) {
    for (std::uint64_t i = 0; i < 15; ++i) {
        Rng rng(93, i);
        const Vec2d lo{rng.uniform(-2, 0), rng.uniform(-2, 0)};
        const Rectangle rectangle{lo, {rng.uniform(0, 2), rng.uniform(0, 2)}};
        const double exact = integrate(rectangle, yaw_pitch_density);
        EXPECT_NEAR(polygon_yaw_pitch_rad2(to_polygon(rectangle), pi / 2), exact, 1e-5);
    }
}

// The great circle's longitude integral is additive: cutting a polygon must not change the sum by
// more than the stated error, whatever the slopes of the cuts.
TEST(YawPitch, IsAdditiveWithinItsErrorBound) {
    for (std::uint64_t i = 0; i < 3000; ++i) {
        Rng rng(94, i);
        const double size = std::pow(10, rng.uniform(-3, 3));
        std::array<Vec2d, 6> points;
        for (Vec2d& point : points) {
            const double x = rng.uniform(-size, size);
            point = {x, rng.uniform(-size, size)};
        }
        const ConvexPolygon whole = convex_hull(points);
        const Vec2d a{rng.uniform(-1, 1), rng.uniform(-1, 1)};
        const double offset = rng.uniform(-0.3, 0.3) * size;
        const auto height = [&](Vec2d p) { return a.x * p.x + a.y * p.y - offset; };
        const ConvexPolygon above = clipped(whole, height);
        const ConvexPolygon below = clipped(whole, [&](Vec2d p) { return -height(p); });
        for (const double limit : {pi / 2, 0.7, 0.1})
            EXPECT_NEAR(
                polygon_yaw_pitch_rad2(above, limit) + polygon_yaw_pitch_rad2(below, limit),
                polygon_yaw_pitch_rad2(whole, limit),
                1e-9 * static_cast<double>(whole.size() + 2)
            );
    }
}

struct Emitter {
    PerspectiveWindow window;
    Aabb box;
};

Emitter random_emitter(Rng& rng) {
    Emitter emitter;
    emitter.window.eye = random_point(rng, 1);
    emitter.window.frame = random_frame(rng);
    emitter.window.tan_x = rng.uniform(0.05, 2);
    emitter.window.tan_y = rng.uniform(0.05, 2);
    emitter.window.near = rng.below(2) == 0 ? 0 : rng.uniform(0.01, 0.6);
    const Vec3d along = emitter.window.frame.forward * rng.uniform(-0.4, 2);
    emitter.box = random_box(rng, emitter.window.eye + along + random_point(rng, 0.8), 0.8);
    return emitter;
}

template <class Draw>
void expect_share_of_rays(const Emitter& emitter, double share, const Draw& draw) {
    constexpr int rays = 4000;
    int hits = 0;
    for (int k = 0; k < rays; ++k) {
        const Vec3d direction = draw();
        const double start = emitter.window.near / dot(direction, emitter.window.frame.forward);
        hits += meets(emitter.box, emitter.window.eye, direction, start) ? 1 : 0;
    }
    // Five standard deviations of a binomial share; 1e-3 stands in for shares near 0 and 1.
    const double spread = std::sqrt(std::max(share * (1 - share), 1e-3) / rays);
    EXPECT_NEAR(static_cast<double>(hits) / rays, share, 5 * spread);
}

TEST(SolidAngleProjection, AgreesWithIsotropicRays) {
    for (std::uint64_t i = 0; i < 300; ++i) {
        Rng rng(95, i);
        const Emitter emitter = random_emitter(rng);
        const PerspectiveWindow& window = emitter.window;
        const double share = SolidAngleProjection(window)(emitter.box);
        expect_share_of_rays(emitter, share, [&] {
            return sample_isotropic(window.frame, window.tan_x, window.tan_y, rng);
        });
    }
}

TEST(YawPitchProjection, AgreesWithSquareCapRays) {
    for (std::uint64_t i = 0; i < 300; ++i) {
        Rng rng(96, i);
        const Emitter emitter = random_emitter(rng);
        const double share = YawPitchProjection(emitter.window)(emitter.box);
        const double half_yaw = std::atan(emitter.window.tan_x);
        const double half_pitch = std::atan(emitter.window.tan_y);
        expect_share_of_rays(emitter, share, [&] {
            return sample_square_cap(emitter.window.frame, half_yaw, half_pitch, rng);
        });
    }
}

TEST(SolidAngleProjection, RefusesWindowsThatAreNoneAsTheOthersDo) {
    EXPECT_THROW(SolidAngleProjection({.tan_x = -1}), Error);
    EXPECT_THROW(YawPitchProjection({.near = -1}), Error);
}

TEST(SolidAngleProjection, BoxesAroundTheEyeAreCertainAndEmptyOnesImpossible) {
    const SolidAngleProjection isotropic({});
    const YawPitchProjection yaw_pitch({});
    EXPECT_NEAR(isotropic(Aabb{{-1, -1, -1}, {1, 1, 1}}), 1, 1e-14);
    EXPECT_NEAR(yaw_pitch(Aabb{{-1, -1, -1}, {1, 1, 1}}), 1, 1e-8);
    EXPECT_EQ(isotropic(Aabb{}), 0);
    EXPECT_EQ(yaw_pitch(Aabb{}), 0);
    EXPECT_EQ(isotropic(Aabb{{-1, -1, -3}, {1, 1, -2}}), 0);
    EXPECT_EQ(yaw_pitch(Aabb{{-1, -1, -3}, {1, 1, -2}}), 0);
}

TEST(SolidAngleProjection, AllThreeMeasuresAreMonotoneUpToTheirErrors) {
    for (std::uint64_t i = 0; i < 5000; ++i) {
        Rng rng(97, i);
        const Emitter emitter = random_emitter(rng);
        const Aabb outer = unite(emitter.box, to_float(random_point(rng, 2)));
        const SolidAngleProjection isotropic(emitter.window);
        const YawPitchProjection yaw_pitch(emitter.window);
        EXPECT_LE(isotropic(emitter.box), isotropic(outer) + 1e-9);
        EXPECT_LE(yaw_pitch(emitter.box), yaw_pitch(outer) + 1e-6);
    }
}

// The published table of METHOD 3.4: real probability over the pinhole's prediction, for centered
// boxes of 50 % and 20 % of the window's width under yaw-pitch rays.
TEST(YawPitchProjection, ExceedsThePinholeByThePublishedFactors) {
    struct Row {
        double fov_x, fov_y, at_half, at_fifth;
    };

    for (const Row& row : {
             Row{30, 30, 1.03, 1.05},
             Row{70, 50, 1.14, 1.21},
             Row{90, 60, 1.22, 1.37},
             Row{90, 90, 1.35, 1.57},
             Row{130, 45, 1.34, 1.83},
         }) {
        const PerspectiveWindow window{
            .tan_x = tan_of_half(row.fov_x), .tan_y = tan_of_half(row.fov_y)
        };
        const auto factor = [&](double width) {
            const auto x = static_cast<float>(window.tan_x * width);
            const auto y = static_cast<float>(window.tan_y * width);
            const Aabb sheet{{-x, -y, 1}, {x, y, 1}};
            return YawPitchProjection(window)(sheet) / PerspectiveProjection(window)(sheet);
        };
        EXPECT_NEAR(factor(0.5), row.at_half, 0.0051);
        EXPECT_NEAR(factor(0.2), row.at_fifth, 0.0051);
    }
}

} // namespace
} // namespace raywise
