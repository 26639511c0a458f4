#include <raywise/distribution/influence_area.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/sampling.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace raywise {
namespace {

const Aabb scene{{-2, 0, -3}, {4, 5, 1}};

const ParallelParams& parallel_params(const InfluenceArea& area) {
    return std::get<ParallelDistribution>(area.distribution).params();
}

const RadialParams& radial_params(const InfluenceArea& area) {
    return std::get<RadialDistribution>(area.distribution).params();
}

TEST(InfluenceArea, ParallelWindowCoversTheRegionFromItsBack) {
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(1, i);
        const Vec3d direction = sample_sphere(rng);
        const Region regions[] = {
            scene,
            obb_around(scene),
            obb_around(scene, direction),
            Frustum{.eye = {1, 2, 3}, .frame = frame_along(sample_sphere(rng)), .near = 1, .far = 4}
        };
        for (const Region& region : regions) {
            const auto area =
                InfluenceArea::parallel("sun", {.direction = direction, .region = region});
            const ParallelParams& window = parallel_params(area);
            // Nothing of the region is behind the window or beside it: rays drawn at its border
            // frame it, and every point inside is reached by one.
            const Vec3 inside = sample_box(bounds(region), rng);
            if (!contains(region, to_double(inside))) continue;
            const Vec3d seen = to_frame(window.frame, to_double(inside) - window.point);
            EXPECT_LE(std::abs(seen.x), window.half_width * (1 + 1e-12));
            EXPECT_LE(std::abs(seen.y), window.half_height * (1 + 1e-12));
            EXPECT_GE(seen.z, -1e-12);
            EXPECT_NEAR(dot(window.frame.forward, direction), 1, 1e-12);
        }
    }
}

TEST(InfluenceArea, ParallelWindowOfAnAlignedBoxIsItsFace) {
    const Vec3d direction{0.3, -0.8, 0.5};
    const Frame frame = frame_along(direction, 0.7);
    const Obb region{{1, 2, 3}, frame, {2, 3, 4}};
    for (const double sign : {-1.0, 1.0}) {
        const auto area =
            InfluenceArea::parallel("sun", {.direction = direction * sign, .region = region});
        const ParallelParams& window = parallel_params(area);
        EXPECT_NEAR(window.half_width * window.half_height, 6, 1e-9);
        EXPECT_NEAR(dot(window.point - region.center, frame.forward), -4 * sign, 1e-9);
    }
}

TEST(InfluenceArea, RadialTakesTheWindowOfItsFrustum) {
    const Frustum frustum{
        .eye = {0, 3, 0}, .frame = frame_along({1, -1, 0}), .tan_x = 0.5, .tan_y = 2, .far = 9
    };
    const auto area = InfluenceArea::radial("lamp", {.apex = frustum.eye, .region = frustum});
    const RadialParams& params = radial_params(area);
    ASSERT_TRUE(params.window.has_value());
    EXPECT_EQ(params.window->tan_x, 0.5);
    EXPECT_EQ(params.window->tan_y, 2);
    EXPECT_EQ(params.frame.forward, frustum.frame.forward);
    EXPECT_EQ(params.emission, Emission::isotropic);
}

TEST(InfluenceArea, RadialWindowCoversARegionInFrontOfTheApex) {
    const auto area = InfluenceArea::radial(
        "camera", {.apex = {10, 20, -5}, .region = scene, .emission = Emission::pinhole}
    );
    const RadialParams& params = radial_params(area);
    ASSERT_TRUE(params.window.has_value());
    // The whole region is seen, and nothing smaller would do: its measure is below 1.
    for (int i = 0; i < 8; ++i) {
        const Vec3d seen = to_frame(params.frame, to_double(scene.vertex(i)) - params.eye);
        EXPECT_LE(std::abs(seen.x), seen.z * params.window->tan_x * (1 + 1e-12));
        EXPECT_LE(std::abs(seen.y), seen.z * params.window->tan_y * (1 + 1e-12));
    }
    const double share = hit_probability(area.distribution, scene);
    EXPECT_GT(share, 0.4);
    EXPECT_LT(share, 1);
}

TEST(InfluenceArea, RadialAroundTheApexShinesInAllDirections) {
    const auto area = InfluenceArea::radial("lamp", {.apex = {0, 1, 0}, .region = scene});
    EXPECT_FALSE(radial_params(area).window.has_value());
    EXPECT_THROW(
        (void)InfluenceArea::radial(
            "camera", {.apex = {0, 1, 0}, .region = scene, .emission = Emission::pinhole}
        ),
        Error
    );
}

TEST(InfluenceArea, PlaneFormIsABoxBehindItsRectangle) {
    const auto area = InfluenceArea::plane(
        "plane",
        {.point = {10, 3, 0}, .normal = {-2, 0, 0}, .half_width = 6, .half_height = 2.5, .depth = 35
        }
    );
    const Aabb box = bounds(area.region);
    EXPECT_NEAR(box.lo.x, -25, 1e-4);
    EXPECT_NEAR(box.hi.x, 10, 1e-4);
    EXPECT_NEAR(box.lo.y, 0.5, 1e-4);
    EXPECT_NEAR(box.hi.z, 6, 1e-4);
    const ParallelParams& window = parallel_params(area);
    EXPECT_EQ(window.point, (Vec3d{10, 3, 0}));
    EXPECT_EQ(window.frame.forward, (Vec3d{-1, 0, 0}));
    EXPECT_EQ(window.half_width, 6);
}

TEST(InfluenceArea, PlaneFormWorksStraightDown) {
    const auto noon =
        InfluenceArea::plane("noon", {.point = {0, 9, 0}, .normal = {0, -1, 0}, .depth = 9});
    EXPECT_TRUE(is_affine(noon, {.origin = {0.5F, 1, 0.5F}, .direction = {0, 1, 0}}));
}

TEST(InfluenceArea, PointFormStartsOnTheNearPlane) {
    const auto area = InfluenceArea::point(
        "point",
        {.eye = {15, 2.7, 0},
         .direction = {-1, 0, 0},
         .fov_x_deg = 70,
         .fov_y_deg = 35,
         .near = 1,
         .far = 35,
         .emission = Emission::yaw_pitch}
    );
    const RadialParams& params = radial_params(area);
    EXPECT_EQ(params.start_depth, 1);
    EXPECT_NEAR(params.window->tan_x, std::tan(35 * std::numbers::pi / 180), 1e-15);
    const auto& region = std::get<Frustum>(area.region);
    EXPECT_EQ(region.near, 1);
    EXPECT_EQ(region.far, 35);
    EXPECT_EQ(region.tan_y, params.window->tan_y);
}

TEST(InfluenceArea, MeasuredRegionHoldsTheOrigins) {
    MeasuredArea recorded{.rays = {.rays = {}, .bounds = scene}};
    for (std::uint64_t i = 0; i < 100; ++i) {
        Rng rng(2, i);
        const Vec3 origin = sample_box(scene, rng);
        recorded.rays.rays.push_back({{.origin = origin, .direction = {1, 0.5F, rng.uniform()}}, 1}
        );
    }
    const auto area = InfluenceArea::measured("record", recorded);
    for (const RecordedRay& ray : recorded.rays.rays)
        EXPECT_TRUE(is_affine(area, ray.ray));
    EXPECT_FALSE(is_affine(area, {.origin = {40, 0, 0}, .direction = {1, 0, 0}}));
}

TEST(InfluenceArea, RefusalNamesTheAreaAndTheReason) {
    const auto reason = [](const auto& make) -> std::string {
        try {
            (void)make();
        } catch (const Error& error) {
            return error.what();
        }
        return "accepted";
    };
    using ::testing::HasSubstr;
    const std::string no_direction =
        reason([] { return InfluenceArea::parallel("sun", {.direction = {}, .region = scene}); });
    EXPECT_THAT(no_direction, HasSubstr("'sun'"));
    EXPECT_THAT(no_direction, HasSubstr("direction"));
    const auto sun = [](double density, const Affinity& affinity) {
        return InfluenceArea::parallel(
            "sun",
            {.direction = {0, -1, 0}, .region = scene, .density = density, .affinity = affinity}
        );
    };
    EXPECT_THAT(reason([&] { return sun(0, {}); }), HasSubstr("density"));
    EXPECT_THAT(reason([&] { return sun(1, {.angle_deg = 91}); }), HasSubstr("angle"));
    EXPECT_THAT(reason([&] { return sun(1, {.distance = 1}); }), HasSubstr("distance"));
    EXPECT_THAT(
        reason([] { return InfluenceArea::parallel("", {.direction = {0, 1, 0}, .region = scene}); }
        ),
        HasSubstr("name")
    );
    EXPECT_THAT(
        reason([] {
            return InfluenceArea::parallel("sun", {.direction = {0, 1, 0}, .region = Aabb{}});
        }),
        HasSubstr("region")
    );
    const Aabb plate{{0, 0, 0}, {1, 1, 0}};
    EXPECT_THAT(
        reason([&] {
            return InfluenceArea::parallel("sun", {.direction = {0, 1, 0}, .region = plate});
        }),
        HasSubstr("shadow")
    );
    EXPECT_THAT(
        reason([] { return InfluenceArea::plane("plane", {.normal = {0, 1, 0}, .depth = 0}); }),
        HasSubstr("depth")
    );
    EXPECT_THAT(
        reason([] {
            return InfluenceArea::point("point", {.direction = {0, 1, 0}, .near = 2, .far = 1});
        }),
        HasSubstr("far")
    );
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(
        reason([] { return InfluenceArea::radial("lamp", {.apex = {nan, 0, 0}, .region = scene}); }
        ),
        HasSubstr("apex")
    );
}

/// A ray from `origin` at an angle off `direction`.
Ray tilted(Vec3 origin, Vec3d direction, double angle_deg, double turn) {
    const Frame frame = frame_along(direction, turn);
    const double angle = angle_deg * std::numbers::pi / 180;
    const Vec3d tilted = frame.forward * std::cos(angle) + frame.right * std::sin(angle);
    return {.origin = origin, .direction = to_float(tilted * 3.0)};
}

TEST(Affinity, OfParallelAreasIsAnAngleWhicheverWayTheRayRuns) {
    const Vec3d direction{0.3, -0.8, 0.5};
    const auto area = InfluenceArea::parallel("sun", {.direction = direction, .region = scene});
    const Vec3 inside{0, 1, 0};
    for (const double sign : {-1.0, 1.0}) {
        EXPECT_TRUE(is_affine(area, tilted(inside, direction * sign, 0, 1)));
        EXPECT_TRUE(is_affine(area, tilted(inside, direction * sign, 8.1, 2)));
        EXPECT_FALSE(is_affine(area, tilted(inside, direction * sign, 8.2, 3)));
    }
    EXPECT_FALSE(is_affine(area, tilted({9, 9, 9}, direction, 0, 0))) << "starts outside";
}

TEST(Affinity, OfRadialAreasFollowsTheLineFromTheEye) {
    const Vec3d eye{1, 3, 0};
    const auto area =
        InfluenceArea::radial("lamp", {.apex = eye, .region = scene, .affinity = {.angle_deg = 5}});
    const Vec3 inside{0, 1, -2};
    const Vec3d away = to_double(inside) - eye;
    EXPECT_TRUE(is_affine(area, tilted(inside, away, 4.9, 1)));
    EXPECT_TRUE(is_affine(area, tilted(inside, -away, 4.9, 1)));
    EXPECT_FALSE(is_affine(area, tilted(inside, away, 5.1, 1)));
    EXPECT_TRUE(is_affine(area, tilted(to_float(eye), {0, 1, 0}, 0, 0))) << "starts at the eye";
}

TEST(Affinity, ByDistanceAsksHowCloseTheLinePassesTheEye) {
    const auto area = InfluenceArea::radial(
        "lamp", {.apex = {1, 3, 0}, .region = scene, .affinity = {.distance = 0.5}}
    );
    EXPECT_TRUE(is_affine(area, {.origin = {1.4F, 1, 0}, .direction = {0, 2, 0}}));
    EXPECT_FALSE(is_affine(area, {.origin = {1.6F, 1, 0}, .direction = {0, 2, 0}}));
}

TEST(Affinity, NeverHoldsForInvalidRays) {
    const auto area = InfluenceArea::parallel("sun", {.direction = {0, -1, 0}, .region = scene});
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(is_affine(area, {.origin = {0, 1, 0}, .direction = {}}));
    EXPECT_FALSE(is_affine(area, {.origin = {0, nan, 0}, .direction = {0, 1, 0}}));
    EXPECT_FALSE(is_exact(area, {.origin = {0, 1, 0}, .direction = {0, nan, 0}}));
}

TEST(IsExact, HoldsForRaysOfThePencilRoundedToFloat) {
    const Vec3d direction{0.3, -0.8, 0.5};
    const Vec3d eye{1.3, 3.1, 0.2};
    const auto sun = InfluenceArea::parallel("sun", {.direction = direction, .region = scene});
    const auto lamp = InfluenceArea::radial("lamp", {.apex = eye, .region = scene});
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng rng(3, i);
        const Vec3 origin = sample_box(scene, rng);
        const Vec3 along = to_float(direction * rng.uniform(-9, 9));
        EXPECT_TRUE(is_exact(sun, {.origin = origin, .direction = along}));
        const Vec3 to_eye = to_float(eye - to_double(origin));
        EXPECT_TRUE(is_exact(lamp, {.origin = origin, .direction = to_eye}));
        const Vec3 beside = to_eye + Vec3{0.01F, 0, 0};
        EXPECT_TRUE(is_affine(lamp, {.origin = origin, .direction = to_eye}));
        if (std::abs(to_eye.y) > 0.1F) {
            EXPECT_FALSE(is_exact(lamp, {.origin = origin, .direction = beside}));
        }
    }
    EXPECT_FALSE(is_exact(sun, tilted({0, 1, 0}, direction, 0.001, 0)));
    const InfluenceArea anywhere{
        .name = "all", .region = scene, .distribution = UniformDistribution(scene)
    };
    EXPECT_TRUE(is_affine(anywhere, tilted({0, 1, 0}, direction, 0, 0)));
    EXPECT_FALSE(is_exact(anywhere, tilted({0, 1, 0}, direction, 0, 0)));
}

TEST(ObbAround, HoldsTheBoundsTightly) {
    for (std::uint64_t i = 0; i < 500; ++i) {
        Rng rng(4, i);
        const Vec3d direction = sample_sphere(rng) * rng.uniform(0.1, 9);
        const Obb box = obb_around(scene, direction);
        EXPECT_TRUE(contains(Region(box), scene));
        EXPECT_NEAR(dot(box.frame.forward, direction), length(direction), 1e-9);
        const Obb smaller{box.center, box.frame, box.half * (1 - 1e-9)};
        EXPECT_FALSE(contains(Region(smaller), scene));
    }
    EXPECT_TRUE(contains(Region(obb_around(scene)), scene));
    EXPECT_NEAR(volume(obb_around(scene)), 6 * 5 * 4, 1e-6);
    EXPECT_THROW((void)obb_around(Aabb{}), Error);
}

} // namespace
} // namespace raywise
