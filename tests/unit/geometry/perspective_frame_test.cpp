#include <raywise/geometry/perspective_frame.hpp>

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

TEST(PerspectiveFrame, RefusesFacesThatAreNone) {
    EXPECT_THROW((void)PerspectiveFrame({0, 0, 0}, 3, 1), Error);
    EXPECT_THROW((void)PerspectiveFrame({0, 0, 0}, -1, 1), Error);
    EXPECT_THROW((void)PerspectiveFrame({0, 0, 0}, 0, 0), Error);
    EXPECT_THROW((void)PerspectiveFrame({std::nan(""), 0, 0}, 0, 1), Error);
    EXPECT_THROW((void)PerspectiveFrame::facing({0, 0, 0}, {0, 0, 0}), Error);
}

TEST(PerspectiveFrame, RaysThroughTheApexShareTheirPlaceAndGrowInDepth) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(131, i);
        const Vec3d apex = testing::random_point(rng, 2);
        const Vec3d direction = sample_sphere(rng);
        const PerspectiveFrame frame = PerspectiveFrame::facing(apex, direction);
        EXPECT_TRUE(frame.contains(apex + direction));
        EXPECT_FALSE(frame.contains(apex - direction));
        const Vec3d a = frame.to_frame(apex + direction * 0.5);
        const Vec3d b = frame.to_frame(apex + direction * 7.0);
        EXPECT_NEAR(a.x, b.x, 1e-13);
        EXPECT_NEAR(a.y, b.y, 1e-13);
        EXPECT_LT(a.z, b.z);
        EXPECT_LT(b.z, 0);
    }
}

TEST(PerspectiveFrame, LinesStayLines) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(132, i);
        const Vec3d apex = testing::random_point(rng, 2);
        const PerspectiveFrame frame = PerspectiveFrame::facing(apex, sample_sphere(rng));
        const Vec3d a = frame.from_frame({rng.uniform(-1, 1), rng.uniform(-1, 1), -2});
        const Vec3d b = frame.from_frame({rng.uniform(-1, 1), rng.uniform(-1, 1), -0.3});
        const Vec3d start = frame.to_frame(a);
        const Vec3d middle = frame.to_frame(a + (b - a) * rng.uniform_double()) - start;
        const Vec3d whole = frame.to_frame(b) - start;
        EXPECT_NEAR(length(cross(middle, whole)), 0, 1e-12);
    }
}

TEST(PerspectiveFrame, FromFrameIsTheInverseAndTheSixFacesCoverEveryDirection) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(133, i);
        const Vec3d apex = testing::random_point(rng, 2);
        const Vec3d point = apex + sample_sphere(rng) * rng.uniform(0.1, 9);
        int faces = 0;
        for (int axis = 0; axis < 3; ++axis)
            for (const int sign : {-1, 1}) {
                const PerspectiveFrame frame(apex, axis, sign);
                if (!frame.contains(point)) continue;
                ++faces;
                const Vec3d at = frame.to_frame(point);
                EXPECT_LE(std::abs(at.x), 1);
                EXPECT_LE(std::abs(at.y), 1);
                EXPECT_NEAR(length(frame.from_frame(at) - point), 0, 1e-13);
            }
        EXPECT_EQ(faces, 1);
    }
    const PerspectiveFrame frame({0, 0, 0}, 0, 1);
    EXPECT_FALSE(frame.contains({0, 0, 0}));
    EXPECT_TRUE(frame.contains({1, 1, -1})); // an edge of the cube belongs to both faces
    EXPECT_TRUE(PerspectiveFrame({0, 0, 0}, 1, 1).contains({1, 1, -1}));
}

} // namespace
} // namespace raywise
