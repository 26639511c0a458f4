#include <raywise/distribution/discretized.hpp>

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raywise {
namespace {

const Region everywhere = Aabb{{-9, -9, -9}, {9, 9, 9}};

TEST(Discretized, SunDiskBecomesExactSunsSpreadEvenlyBySolidAngle) {
    const InfluenceArea sun = InfluenceArea::parallel(
        "sun", {.direction = {0.3, -0.8, 0.5}, .region = everywhere, .cone_half_angle_deg = 2}
    );
    const Vec3d axis = std::get<ParallelDistribution>(sun.distribution).params().frame.forward;
    const double cone = 2 * std::numbers::pi / 180;
    const auto suns = discretized(sun, 400);
    ASSERT_EQ(suns.size(), 400U);
    EXPECT_EQ(suns[7].name, "sun/7");
    Vec3d mean;
    std::size_t inner = 0; // within the cap of half the solid angle
    for (const InfluenceArea& point : suns) {
        const auto& params = std::get<ParallelDistribution>(point.distribution).params();
        EXPECT_EQ(params.cone_half_angle_deg, 0);
        const double cosine = dot(params.frame.forward, axis);
        EXPECT_GE(cosine, std::cos(cone) - 1e-12);
        inner += 1 - cosine < (1 - std::cos(cone)) / 2 ? 1U : 0U;
        mean = mean + params.frame.forward / 400.0;
    }
    EXPECT_NEAR(static_cast<double>(inner), 200, 2);
    EXPECT_LT(length(cross(mean, axis)), 0.05 * cone);
}

TEST(Discretized, LampBecomesPointsSpreadOverItsBall) {
    const InfluenceArea lamp =
        InfluenceArea::radial("lamp", {.apex = {1, 2, 3}, .region = everywhere, .radius = 0.5});
    Vec3d mean;
    std::size_t inner = 0; // within the ball of half the volume
    for (const InfluenceArea& point : discretized(lamp, 1000)) {
        const auto& params = std::get<RadialDistribution>(point.distribution).params();
        EXPECT_EQ(params.radius, 0);
        const Vec3d shift = params.eye - Vec3d{1, 2, 3};
        EXPECT_LE(length(shift), 0.5);
        inner += length(shift) < 0.5 * std::cbrt(0.5) ? 1U : 0U;
        mean = mean + shift / 1000.0;
    }
    EXPECT_NEAR(static_cast<double>(inner), 500, 10);
    EXPECT_LT(length(mean), 0.02);
}

TEST(Discretized, ExactAreaStaysWhereItIs) {
    const InfluenceArea lamp =
        InfluenceArea::radial("lamp", {.apex = {1, 2, 3}, .region = everywhere});
    const auto points = discretized(lamp, 2);
    for (const InfluenceArea& point : points) {
        EXPECT_EQ(std::get<RadialDistribution>(point.distribution).params().eye, (Vec3d{1, 2, 3}));
        EXPECT_EQ(point.density, 0.5);
    }
}

TEST(Discretized, RefusesNoPointsAndAreasWithoutEmitter) {
    const InfluenceArea lamp =
        InfluenceArea::radial("lamp", {.apex = {1, 2, 3}, .region = everywhere});
    EXPECT_THROW(static_cast<void>(discretized(lamp, 0)), Error);
    const InfluenceArea sky{
        .name = "sky",
        .region = everywhere,
        .distribution = UniformDistribution(std::get<Aabb>(everywhere))
    };
    EXPECT_THROW(static_cast<void>(discretized(sky, 4)), Error);
}

} // namespace
} // namespace raywise
