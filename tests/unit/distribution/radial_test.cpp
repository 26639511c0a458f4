#include <raywise/distribution/radial.hpp>

#include "support/statistics.hpp"

#include <raywise/core/error.hpp>
#include <raywise/distribution/monte_carlo.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/solid_angle.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace raywise {
namespace {

Aabb random_box(Rng& rng, Vec3d middle, double spread) {
    const Vec3d center =
        middle +
        Vec3d{
            rng.uniform(-spread, spread), rng.uniform(-spread, spread), rng.uniform(-spread, spread)
        };
    const Vec3d half{rng.uniform(0, 1), rng.uniform(0, 1), rng.uniform(0, 1)};
    return {to_float(center - half), to_float(center + half)};
}

TEST(RadialMeasure, EyeInsideTheBoxIsCertain) {
    for (const Emission emission : {Emission::pinhole, Emission::isotropic, Emission::yaw_pitch}) {
        const RadialParams params{.window = RadialWindow{}, .emission = emission};
        EXPECT_EQ(RadialMeasure(params)({{-1, -1, -1}, {1, 1, 1}}), 1);
        EXPECT_EQ(RadialMeasure(params)({{-1, -1, -1}, {1, 1, 0}}), 1) << "the eye is on a face";
    }
    const RadialParams around{.window = std::nullopt, .emission = Emission::isotropic};
    EXPECT_EQ(RadialMeasure(around)({{-1, -1, -1}, {1, 1, 1}}), 1);
}

TEST(RadialMeasure, EyeInsideTheBoxIsNotEnoughWhenRaysStartOnTheNearPlane) {
    const RadialParams params{.window = RadialWindow{}, .start_depth = 1};
    // At depth 1 the box covers a quarter of the window, beyond it less.
    EXPECT_FLOAT_EQ(RadialMeasure(params)({{-0.5F, -0.5F, -1}, {0.5F, 0.5F, 3}}), 0.25F);
}

TEST(RadialMeasure, BoxBehindTheStartHasMeasureZero) {
    for (const Emission emission : {Emission::pinhole, Emission::isotropic, Emission::yaw_pitch}) {
        const RadialParams params{.window = RadialWindow{}, .emission = emission, .start_depth = 1};
        EXPECT_EQ(RadialMeasure(params)({{-1, -1, -9}, {1, 1, -1}}), 0);
        EXPECT_EQ(RadialMeasure(params)({{-1, -1, 0.25F}, {1, 1, 0.75F}}), 0);
    }
}

/// How much more often yaw-pitch rays meet a centered plate than the pinhole area says, from
/// [Falcone24] by way of the method's section 3.4.
TEST(RadialMeasure, YawPitchRaysMeetACenteredPlateAsOftenAsTheMethodsTableSays) {
    struct Row {
        double fov_x_deg;
        double fov_y_deg;
        double half_window;
        double fifth_window;
    };

    const Row rows[] = {
        {30, 30, 1.03, 1.05},
        {70, 50, 1.14, 1.21},
        {90, 60, 1.22, 1.37},
        {90, 90, 1.35, 1.57},
        {130, 45, 1.34, 1.83},
    };
    for (const Row& row : rows) {
        const RadialWindow window = window_of_fov(row.fov_x_deg, row.fov_y_deg);
        const RadialMeasure yaw_pitch({.window = window, .emission = Emission::yaw_pitch});
        const RadialMeasure pinhole({.window = window, .emission = Emission::pinhole});
        const auto ratio = [&](double part) {
            const Vec3 corner = to_float({part * window.tan_x, part * window.tan_y, 1});
            const Aabb plate{{-corner.x, -corner.y, 1}, corner};
            return static_cast<double>(yaw_pitch(plate) / pinhole(plate));
        };
        EXPECT_NEAR(ratio(0.5), row.half_window, 0.006) << row.fov_x_deg;
        EXPECT_NEAR(ratio(0.2), row.fifth_window, 0.006) << row.fov_x_deg;
    }
}

TEST(RadialMeasure, FarEyeSeesAsParallelRaysDo) {
    const double distance = 1e5;
    const Frame frame = frame_along({1, -2, 0.5});
    const Vec3d eye = frame.forward * -distance;
    const double reach = 2;
    const ParallelMeasure parallel(ParallelParams{
        .point = frame.forward * -9.0, .frame = frame, .half_width = reach, .half_height = reach
    });
    for (const Emission emission : {Emission::pinhole, Emission::isotropic, Emission::yaw_pitch}) {
        const RadialMeasure radial(
            {.eye = eye,
             .frame = frame,
             .window = RadialWindow{reach / distance, reach / distance},
             .emission = emission}
        );
        for (std::uint64_t i = 0; i < 200; ++i) {
            Rng rng(6, i);
            const Aabb box = random_box(rng, {}, 2);
            EXPECT_NEAR(radial(box), parallel(box), 1e-4F);
        }
    }
}

TEST(RadialMeasure, AllAroundIsTheSolidAngle) {
    const Vec3d eye{0.5, 0.25, -0.125};
    const RadialMeasure measure({.eye = eye, .emission = Emission::isotropic});
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(7, i);
        const Aabb box = random_box(rng, eye, 3);
        EXPECT_NEAR(
            static_cast<double>(measure(box)),
            solid_angle_sr(box, eye) / (4 * std::numbers::pi),
            1e-7
        );
    }
}

TEST(RadialMeasure, SixWindowsOfACubeMakeUpAllAround) {
    const Vec3d eye{0.5, 0.25, -0.125};
    const RadialMeasure around({.eye = eye, .emission = Emission::isotropic});
    for (std::uint64_t i = 0; i < 100; ++i) {
        Rng rng(8, i);
        const Aabb box = random_box(rng, eye, 3);
        double sum = 0;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double sign : {-1.0, 1.0}) {
                Vec3d forward;
                forward[axis] = sign;
                const RadialMeasure face(
                    {.eye = eye,
                     .frame = frame_along(forward),
                     .window = RadialWindow{1, 1},
                     .emission = Emission::isotropic}
                );
                sum += static_cast<double>(face(box)) / 6;
            }
        }
        EXPECT_NEAR(sum, static_cast<double>(around(box)), 1e-6);
    }
}

TEST(RadialMeasure, NarrowedToABoxIsTheSameInsideIt) {
    for (const Emission emission : {Emission::pinhole, Emission::isotropic, Emission::yaw_pitch}) {
        const RadialMeasure measure({.window = window_of_fov(80, 60), .emission = emission});
        for (std::uint64_t i = 0; i < 300; ++i) {
            Rng rng(11, i);
            const Aabb outer = random_box(rng, {0, 0, 3}, 3);
            const Aabb inner = intersect(outer, random_box(rng, to_double(outer.center()), 0.5));
            EXPECT_NEAR(measure.narrowed(outer)(inner), measure(inner), 1e-6F);
            EXPECT_NEAR(measure.narrowed(outer)(outer), measure(outer), 1e-6F);
        }
    }
}

TEST(RadialMeasure, ThesisModeGivesZeroAroundTheEyeAndPinholeAreasElsewhere) {
    const RadialParams params{.window = RadialWindow{}, .emission = Emission::yaw_pitch};
    const RadialMeasure thesis(params, MeasureMode::thesis);
    EXPECT_EQ(thesis({{-1, -1, -1}, {1, 1, 1}}), 0);
    RadialParams pinhole = params;
    pinhole.emission = Emission::pinhole;
    const Aabb box{{-0.25F, -0.5F, 1}, {0.5F, 0.25F, 2}};
    EXPECT_EQ(thesis(box), RadialMeasure(pinhole)(box));
    EXPECT_NE(thesis(box), RadialMeasure(params)(box));
}

TEST(RadialMeasure, EmitterRadiusIsAveragedToItsDocumentedError) {
    // Boxes farther away than four radii: the formula for the ball is of degree 5.
    for (const bool all_around : {true, false}) {
        RadialParams params{.emission = Emission::isotropic, .radius = 0.5};
        if (!all_around) params.window = window_of_fov(90, 90);
        const RadialDistribution rays(params);
        const RadialMeasure measure = rays.measure();
        const Aabb box{{-0.5F, -0.5F, 2}, {0.5F, 0.75F, 3}};
        const ShareEstimate sampled = count_share(rays, box, {.samples = 400'000});
        EXPECT_TRUE(testing::agrees(sampled, static_cast<double>(measure(box)), 2e-4));
    }
}

TEST(RadialMeasure, SharedIsNoMoreThanEitherAndAllOfANestedBox) {
    const RadialMeasure measure({.window = window_of_fov(80, 60)});
    for (std::uint64_t i = 0; i < 300; ++i) {
        Rng rng(9, i);
        const Aabb a = random_box(rng, {0, 0, 2}, 2);
        const Aabb b = random_box(rng, {0, 0, 2}, 2);
        const double shared = measure.shared(a, b).value();
        EXPECT_LE(shared, static_cast<double>(std::min(measure(a), measure(b))) + 1e-6);
        EXPECT_NEAR(measure.shared(a, unite(a, b)).value(), static_cast<double>(measure(a)), 1e-6);
        EXPECT_NEAR(shared, measure.shared(b, a).value(), 1e-9);
        const auto whole = measure.unculled_shared(a, b);
        EXPECT_LE(shared, whole.value_or(1) + 1e-6);
    }
    const RadialMeasure around({.emission = Emission::isotropic});
    EXPECT_FALSE(around.shared({{1, 1, 1}, {2, 2, 2}}, {{1, 1, 1}, {2, 2, 2}}).has_value());
}

TEST(RadialMeasure, UnculledIgnoresTheWindowAndIsInfiniteAtTheHorizon) {
    const RadialMeasure measure({.window = RadialWindow{1, 1}});
    EXPECT_NEAR(measure.unculled({{10, 10, 2}, {12, 12, 2}}), 0.25, 1e-9);
    EXPECT_EQ(measure.unculled({{1, 1, -1}, {2, 2, 1}}), std::numeric_limits<double>::infinity());
    EXPECT_EQ(measure.unculled({}), 0);
}

TEST(RadialDistribution, StartsAtTheEyeOrOnTheNearPlane) {
    const Frame frame = frame_along({1, 2, 3});
    for (const double depth : {0.0, 2.0}) {
        const RadialDistribution rays(
            {.frame = frame, .window = window_of_fov(100, 40), .start_depth = depth}
        );
        for (std::uint64_t i = 0; i < 100; ++i) {
            Rng rng(10, i);
            const Ray ray = rays.sample(rng);
            EXPECT_NEAR(to_frame(frame, to_double(ray.origin)).z, depth, 1e-6);
        }
    }
}

TEST(RadialDistribution, DirectionAtABoxRunsFromTheEyeToItsCenter) {
    const RadialDistribution rays({.eye = {1, 0, 0}, .window = RadialWindow{}});
    EXPECT_EQ(rays.direction_at({{2, 2, 2}, {4, 4, 4}}), (Vec3d{2, 3, 3}));
    EXPECT_EQ(rays.direction_at({{0, -1, -1}, {2, 1, 1}}), (Vec3d{0, 0, 1})) << "around the eye";
}

TEST(RadialDistribution, RefusesWhatIsOutOfRange) {
    const auto refuses = [](const RadialParams& params) {
        EXPECT_THROW(RadialDistribution{params}, Error);
        EXPECT_THROW(RadialMeasure{params}, Error);
    };
    constexpr double infinity = std::numeric_limits<double>::infinity();
    refuses({.window = std::nullopt, .emission = Emission::pinhole});
    refuses({.window = std::nullopt, .emission = Emission::yaw_pitch});
    refuses({.window = std::nullopt, .emission = Emission::isotropic, .start_depth = 1});
    refuses({.window = RadialWindow{0, 1}});
    refuses({.window = RadialWindow{1, infinity}});
    refuses({.window = RadialWindow{}, .start_depth = -1});
    refuses({.window = RadialWindow{}, .radius = -1});
    refuses({.eye = {infinity, 0, 0}, .window = RadialWindow{}});
    EXPECT_THROW((void)window_of_fov(0, 90), Error);
    EXPECT_THROW((void)window_of_fov(90, 180), Error);
}

} // namespace
} // namespace raywise
