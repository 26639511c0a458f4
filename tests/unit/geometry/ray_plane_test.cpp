#include <raywise/geometry/ray_plane.hpp>

#include <raywise/geometry/ray.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <optional>

namespace raywise {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

TEST(RayPlane, ParallelRaysMissEvenInThePlane) {
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {1, 1, 0}}, {0, 0, 1}, {0, 0, 1}), std::nullopt);
    EXPECT_EQ(intersect_plane({{5, 5, 1}, {1, 1, 0}}, {0, 0, 1}, {0, 0, 1}), std::nullopt);
    // n . d is exactly 0 although its products are not representable in float.
    const Vec3 n{16777215.0F, 16777213.0F, 0};
    EXPECT_EQ(
        intersect_plane({{0, 0, 0}, {16777213.0F, -16777215.0F, 0}}, {1, 1, 1}, n), std::nullopt
    );
}

TEST(RayPlane, NearlyParallelRaysHit) {
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {1, 0, 0x1p-40F}}, {0, 0, 1}, {0, 0, 1}), 0x1p40F);
}

TEST(RayPlane, DistanceIsIndependentOfTheNormalsLengthAndSign) {
    const Ray ray{{0, 0, 0}, {0, 0, 2}};
    for (const float scale : {1.0F, -1.0F, 1e-30F, 1e30F})
        EXPECT_EQ(intersect_plane(ray, {7, 8, 3}, {0, 0, scale}), 1.5F);
}

TEST(RayPlane, IntervalIsClosed) {
    const Vec3 point{0, 0, 3};
    const Vec3 normal{0, 0, 1};
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {0, 0, 1}, 3, 3}, point, normal), 3.0F);
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {0, 0, 1}, 0, 2.9999998F}, point, normal), std::nullopt);
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {0, 0, 1}, 3.0000002F}, point, normal), std::nullopt);
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {0, 0, -1}}, point, normal), std::nullopt);
}

TEST(RayPlane, InvalidInputIsAMiss) {
    EXPECT_EQ(intersect_plane({{0, 0, nan}, {0, 0, 1}}, {0, 0, 3}, {0, 0, 1}), std::nullopt);
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {0, 0, 0}}, {0, 0, 3}, {0, 0, 1}), std::nullopt);
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {0, 0, 1}}, {0, 0, infinity}, {0, 0, 1}), std::nullopt);
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {0, 0, 1}}, {0, 0, 3}, {0, 0, nan}), std::nullopt);
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {0, 0, 1}}, {0, 0, 3}, {0, 0, 0}), std::nullopt);
}

TEST(RayPlane, ParameterBeyondTheFloatsIsAMiss) {
    EXPECT_EQ(intersect_plane({{0, 0, 0}, {0, 0, 1e-30F}}, {0, 0, 1e30F}, {0, 0, 1}), std::nullopt);
}

} // namespace
} // namespace raywise
