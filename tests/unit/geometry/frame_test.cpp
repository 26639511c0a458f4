#include <raywise/geometry/frame.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/vec.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace raywise {
namespace {

void expect_near(Vec3d a, Vec3d b, double tolerance = 1e-14) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

void expect_right_handed_orthonormal(const Frame& frame) {
    EXPECT_NEAR(length(frame.right), 1, 1e-14);
    EXPECT_NEAR(length(frame.forward), 1, 1e-14);
    EXPECT_NEAR(dot(frame.right, frame.forward), 0, 1e-14);
    expect_near(cross(frame.right, frame.up), frame.forward);
}

TEST(Frame, RefusesDirectionsThatAreNone) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_THROW((void)frame_along({0, 0, 0}), Error);
    EXPECT_THROW((void)frame_along({0, infinity, 0}), Error);
    EXPECT_THROW((void)frame_along({0, std::nan(""), 1}), Error);
    EXPECT_THROW((void)frame_along({0, 0, 1}, infinity), Error);
}

// Thesis: a ceiling light or a noon sun yielded NaN.
TEST(Frame, VerticalAndNearlyVerticalDirectionsHaveOne) {
    for (const double sign : {-1.0, 1.0})
        for (const double tilt : {0.0, 1e-300, 1e-17, 1e-9, 0.99e-4, 1.01e-4, 1e-3}) {
            const Vec3d direction{tilt, sign, tilt / 2};
            const Frame frame = frame_along(direction);
            expect_right_handed_orthonormal(frame);
            expect_near(frame.forward, normalized(direction));
        }
    expect_near(frame_along({0, 1, 0}).right, {1, 0, 0});
}

TEST(Frame, WorldUpHasNoPartAlongRightUnlessVertical) {
    for (std::uint64_t i = 0; i < 5000; ++i) {
        Rng rng(81, i);
        const Frame frame = frame_along(sample_sphere(rng));
        expect_right_handed_orthonormal(frame);
        EXPECT_NEAR(frame.right.y, 0, 1e-14);
        EXPECT_GE(frame.up.y, 0);
    }
    expect_near(frame_along({0, 0, 1}).right, {1, 0, 0});
    expect_near(frame_along({0, 0, 1}).up, {0, 1, 0});
}

TEST(Frame, TheLengthOfTheDirectionDoesNotMatter) {
    const Vec3d direction{1, 2, -3};
    const Frame frame = frame_along(direction);
    for (const double scale : {1e-320, 1e-200, 1e200, 5e307}) {
        const Frame scaled = frame_along(direction * scale);
        expect_right_handed_orthonormal(scaled);
        expect_near(scaled.forward, frame.forward, 1e-3); // 1e-320 has few digits itself
    }
}

// Thesis: the order of rotations made the roll a no-op.
TEST(Frame, RollTurnsRightTowardUpByItsAngle) {
    const Vec3d direction{0.3, -0.4, 0.8};
    const Frame level = frame_along(direction);
    const Frame quarter = frame_along(direction, std::numbers::pi / 2);
    expect_near(quarter.right, level.up);
    expect_near(quarter.up, -level.right);
    expect_near(quarter.forward, level.forward);
    const Frame slight = frame_along(direction, 0.1);
    expect_right_handed_orthonormal(slight);
    EXPECT_NEAR(dot(slight.right, level.right), std::cos(0.1), 1e-14);
    EXPECT_NEAR(dot(slight.right, level.up), std::sin(0.1), 1e-14);
}

TEST(Frame, ToAndFromFrameAreInverse) {
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng rng(82, i);
        const Frame frame = testing::random_frame(rng);
        const Vec3d point = testing::random_point(rng, 10);
        expect_near(from_frame(frame, to_frame(frame, point)), point, 1e-13);
    }
}

} // namespace
} // namespace raywise
