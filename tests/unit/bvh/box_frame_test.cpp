#include <raywise/bvh/box_frame.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/triangle.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace raywise {
namespace {

TEST(BoxFrame, RefusesDirectionsThatAreNone) {
    EXPECT_THROW(static_cast<void>(box_frame_along({0, 0, 0})), Error);
    EXPECT_THROW(
        static_cast<void>(box_frame_along({0, std::numeric_limits<double>::quiet_NaN(), 1})), Error
    );
}

TEST(BoxFrame, DefaultIsTheWorld) {
    const BoxFrame world;
    EXPECT_TRUE(world.is_world());
    EXPECT_EQ(world.to_frame({1, 2, 3}), (Vec3{1, 2, 3}));
    EXPECT_TRUE(box_frame_along({0, -2, 0}).is_world()) << "along an axis nothing is sheared";
}

TEST(BoxFrame, PointsAlongTheDirectionShareAllButOneCoordinate) {
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(41, i);
        const auto number = [&] { return 2 * rng.uniform() - 1; };
        const Vec3d direction = to_double(Vec3{number(), number(), number()});
        const BoxFrame frame = box_frame_along(direction);
        EXPECT_EQ(frame.slopes[frame.axis], 0);
        const Vec3 from{number(), number(), number()};
        const Vec3 to = to_float(to_double(from) + direction * 5.0);
        const Vec3 a = frame.to_frame(from);
        const Vec3 b = frame.to_frame(to);
        for (int k = 0; k < 3; ++k) {
            if (k == frame.axis) {
                EXPECT_EQ(a[k], from[k]);
                EXPECT_EQ(b[k], to[k]);
            } else {
                EXPECT_NEAR(a[k], b[k], 4e-6);
            }
        }
    }
}

TEST(BoxFrame, MeshIsTheSameForAnyNumberOfThreads) {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> corners;
    Rng rng(42);
    for (std::uint32_t i = 0; i < 20000; ++i) {
        vertices.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
        corners.push_back({i, i / 2, i / 3});
    }
    const TriangleView view(vertices, corners);
    const BoxFrame frame = box_frame_along({0.3, -1, 0.4});
    const TriangleCopy serial = to_frame(view, frame);
    const TriangleCopy parallel = to_frame(view, frame, Executor(3));
    EXPECT_EQ(serial.vertices, parallel.vertices);
    EXPECT_EQ(serial.corners, parallel.corners);
    const Triangle triangle = view[PrimId{777}];
    EXPECT_EQ(serial.view()[PrimId{777}].v1, frame.to_frame(triangle.v1));
}

} // namespace
} // namespace raywise
