#include <raywise/geometry/shear_frame.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/vec.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace raywise {
namespace {

TEST(ShearFrame, RefusesDirectionsThatAreNone) {
    EXPECT_THROW((void)ShearFrame({0, 0, 0}), Error);
    EXPECT_THROW((void)ShearFrame({0, std::nan(""), 1}), Error);
    EXPECT_THROW((void)ShearFrame({HUGE_VAL, 0, 1}), Error);
}

TEST(ShearFrame, PointsOfOneRayShareTheirPlaceAndGrowInDepth) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(121, i);
        const Vec3d direction = sample_sphere(rng) * std::pow(10, rng.uniform(-9, 9));
        const ShearFrame frame(direction);
        const Vec3d origin = testing::random_point(rng, 5);
        const Vec3d unit = normalized(direction);
        const Vec3d a = frame.to_frame(origin);
        const Vec3d b = frame.to_frame(origin + unit * 3.0);
        EXPECT_NEAR(a.x, b.x, 1e-14 * 20);
        EXPECT_NEAR(a.y, b.y, 1e-14 * 20);
        EXPECT_GT(b.z - a.z, 3 / std::sqrt(3.0) - 1e-12);
    }
}

TEST(ShearFrame, FromFrameIsTheInverseAndVolumesAreKept) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(122, i);
        const ShearFrame frame(sample_sphere(rng));
        const Vec3d point = testing::random_point(rng, 5);
        EXPECT_NEAR(length(frame.from_frame(frame.to_frame(point)) - point), 0, 1e-14);
        const Vec3d x = frame.to_frame({1, 0, 0});
        const Vec3d y = frame.to_frame({0, 1, 0});
        EXPECT_NEAR(std::abs(dot(x, cross(y, frame.to_frame({0, 0, 1})))), 1, 1e-14);
    }
}

TEST(ShearFrame, AxisParallelRaysKeepTheirCoordinatesExactly) {
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
            Vec3d direction;
            direction[axis] = 5 * sign;
            const ShearFrame frame(direction);
            EXPECT_EQ(frame.axis(), axis);
            const Vec3d point{0.1, 0.2, 0.3};
            const Vec3d at = frame.to_frame(point);
            EXPECT_EQ(at.x, point[frame.u_axis()]);
            EXPECT_EQ(at.y, point[frame.v_axis()]);
            EXPECT_EQ(at.z, sign * point[axis]);
        }
}

} // namespace
} // namespace raywise
