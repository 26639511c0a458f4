#include <raywise/distribution/parallel.hpp>

#include "support/statistics.hpp"

#include <raywise/core/error.hpp>
#include <raywise/distribution/monte_carlo.hpp>
#include <raywise/geometry/projected_area.hpp>
#include <raywise/geometry/ray_box.hpp>
#include <raywise/geometry/sampling.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace raywise {
namespace {

Aabb random_box(Rng& rng, double spread, double largest) {
    Vec3d lo;
    Vec3d hi;
    for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = rng.uniform(-spread, spread);
        hi[axis] = lo[axis] + rng.uniform(0, largest);
    }
    return {to_float(lo), to_float(hi)};
}

TEST(ParallelMeasure, BoxInsideTheWindowHasItsClosedForm) {
    const ParallelMeasure measure(ParallelParams{.half_width = 2, .half_height = 3});
    const Aabb box{{-1, -1, 1}, {1, 0.5F, 7}};
    EXPECT_FLOAT_EQ(measure(box), 2 * 1.5F / (4 * 2 * 3));
}

TEST(ParallelMeasure, BoxBehindTheWindowHasMeasureZero) {
    const ParallelMeasure measure(ParallelParams{.point = {0, 0, 1}});
    EXPECT_EQ(measure({{-0.5F, -0.5F, -3}, {0.5F, 0.5F, 0.5F}}), 0);
}

TEST(ParallelMeasure, BoxThatTouchesTheWindowPlaneFromBehindCountsWithItsFace) {
    const ParallelMeasure measure(ParallelParams{});
    EXPECT_FLOAT_EQ(measure({{-0.5F, -0.5F, -3}, {0.5F, 0.5F, 0}}), 0.25F);
}

TEST(ParallelMeasure, BoxAcrossTheWindowPlaneCountsWithItsPartInFront) {
    // The rays run along (1, 0, 1) and start on the plane x + z = 0, which halves the box.
    const ParallelMeasure measure(
        ParallelParams{.frame = frame_along({1, 0, 1}), .half_width = 4, .half_height = 4}
    );
    const Aabb box{{-1, -1, -1}, {1, 1, 1}};
    EXPECT_FLOAT_EQ(measure(box), static_cast<float>(2 * 2 * std::sqrt(2.0) / 64));
}

TEST(ParallelMeasure, BoxLargerThanTheWindowHasMeasureOne) {
    const ParallelMeasure measure(ParallelParams{.frame = frame_along({1, 2, 3})});
    EXPECT_FLOAT_EQ(measure({{-90, -90, -90}, {90, 90, 90}}), 1);
}

TEST(ParallelMeasure, FlatBoxSeenEdgeOnHasMeasureZero) {
    const ParallelMeasure measure(ParallelParams{});
    EXPECT_EQ(measure({{0.25F, -0.5F, 1}, {0.25F, 0.5F, 2}}), 0);
    EXPECT_EQ(measure({{0.25F, 0.25F, 1}, {0.25F, 0.25F, 1}}), 0);
}

TEST(ParallelMeasure, EqualsTheOrthographicProjectionOfGeometry) {
    for (std::uint64_t i = 0; i < 5000; ++i) {
        Rng rng(1, i);
        const Frame frame = frame_along(sample_sphere(rng), rng.uniform(0, 6));
        const double w = rng.uniform(0.5, 3);
        const double h = rng.uniform(0.5, 3);
        const Vec3d point = sample_sphere(rng);
        const ParallelMeasure measure(
            ParallelParams{.point = point, .frame = frame, .half_width = w, .half_height = h}
        );
        const OrthographicProjection oracle(
            {.center = point, .frame = frame, .half_width = w, .half_height = h}
        );
        const Aabb box = random_box(rng, 3, 3);
        EXPECT_NEAR(static_cast<double>(measure(box)), oracle(box), 2e-7);
    }
}

TEST(ParallelMeasure, NarrowedToABoxIsTheSameInsideIt) {
    std::size_t proved_inside = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        Rng rng(2, i);
        const ParallelMeasure measure(ParallelParams{
            .point = {0, 0, -1},
            .frame = frame_along(sample_sphere(rng)),
            .half_width = 4,
            .half_height = 4,
            .cone_half_angle_deg = i % 2 == 0 ? 0 : rng.uniform(0, 20)
        });
        const Aabb outer = random_box(rng, 2, 2);
        const ParallelMeasure narrowed = measure.narrowed(outer);
        Aabb inner = outer;
        for (int axis = 0; axis < 3; ++axis) {
            const float side = outer.size()[axis];
            inner.lo[axis] = std::min(outer.lo[axis] + side * rng.uniform() / 2, outer.hi[axis]);
            inner.hi[axis] = std::max(outer.hi[axis] - side * rng.uniform() / 2, inner.lo[axis]);
        }
        EXPECT_NEAR(narrowed(inner), measure(inner), 1e-6F);
        // A box far outside, which the promise does not cover, shows that the short cut is taken.
        if (narrowed({{50, 50, 50}, {51, 51, 51}}) > 0) ++proved_inside;
    }
    EXPECT_GT(proved_inside, 100U);
    EXPECT_LT(proved_inside, 2900U);
}

TEST(ParallelMeasure, AveragedOverAllDirectionsIsAQuarterOfTheSurface) {
    const Aabb box{{-0.5F, -1, -0.25F}, {0.5F, 1, 0.25F}};
    const double half = 3;
    testing::RunningMean shadow;
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        Rng rng(3, i);
        const Frame frame = frame_along(sample_sphere(rng));
        const ParallelMeasure measure(ParallelParams{
            .point = frame.forward * -5.0, .frame = frame, .half_width = half, .half_height = half
        });
        shadow.add(static_cast<double>(measure(box)) * 4 * half * half);
    }
    const double surface = 2 * static_cast<double>(half_area(box));
    EXPECT_TRUE(testing::agrees(shadow, surface / 4));
}

TEST(ParallelMeasure, ConeErrorStaysBelowTheDocumentedCells) {
    struct Case {
        double cone_deg;
        Aabb box;
        double allowed;
    };

    const Case cases[] = {
        {10, {{-0.5F, -0.5F, 1}, {0.5F, 0.5F, 2}}, 0.003}, // every shadow inside
        {45, {{-0.5F, -0.5F, 0}, {0.5F, 0.5F, 1}}, 0.02},
        {10, {{1.5F, -1, 3}, {2.5F, 1, 4}}, 0.02},         // in the penumbra of the border
        {45, {{-0.1F, -0.1F, 9}, {0.1F, 0.1F, 9}}, 0.002}, // far beyond the penumbra
    };
    for (const Case& c : cases) {
        const ParallelDistribution rays(
            {.half_width = 2, .half_height = 2, .cone_half_angle_deg = c.cone_deg}
        );
        const ShareEstimate sampled = count_share(rays, c.box, {.samples = 200'000});
        const auto share = static_cast<double>(rays.measure()(c.box));
        EXPECT_TRUE(testing::agrees(sampled, share, c.allowed)) << "cone of " << c.cone_deg;
    }
}

TEST(ParallelMeasure, VanishingConeIsNoCone) {
    const ParallelParams params{.half_width = 2, .half_height = 2};
    ParallelParams blurred = params;
    blurred.cone_half_angle_deg = 1e-6;
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(4, i);
        const Aabb box = random_box(rng, 3, 2);
        EXPECT_NEAR(ParallelMeasure(params)(box), ParallelMeasure(blurred)(box), 1e-5F);
    }
}

TEST(ParallelMeasure, SharedIsTheShareOfRaysThatMeetBothBoxes) {
    const ParallelDistribution rays(
        {.point = {0, 0, -3}, .frame = frame_along({1, 0.5, 2}), .half_width = 2, .half_height = 2}
    );
    const ParallelMeasure measure = rays.measure();
    for (std::uint64_t i = 0; i < 40; ++i) {
        Rng rng(5, i);
        const Aabb a = random_box(rng, 1.5, 2);
        const Aabb b = random_box(rng, 1.5, 2);
        const auto draw = [&](Rng& stream) {
            Ray ray = rays.sample(stream);
            if (!intersect(ray, a)) ray.direction = {}; // no longer valid: meets nothing
            return ray;
        };
        const ShareEstimate sampled = count_share(draw, b, {.samples = 5000});
        EXPECT_TRUE(testing::agrees(sampled, measure.shared(a, b)));
        EXPECT_LE(measure.shared(a, b), measure.unculled_shared(a, b) + 1e-12);
    }
}

TEST(ParallelMeasure, UnculledIgnoresTheWindow) {
    const ParallelMeasure measure(ParallelParams{.half_width = 1, .half_height = 1});
    EXPECT_NEAR(measure.unculled({{5, 5, -9}, {9, 9, -8}}), 4, 1e-6);
    EXPECT_EQ(measure.unculled({}), 0);
}

TEST(ParallelDistribution, RefusesWhatIsOutOfRange) {
    const auto refuses = [](const ParallelParams& params) {
        EXPECT_THROW(ParallelDistribution{params}, Error);
        EXPECT_THROW(ParallelMeasure{params}, Error);
    };
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    refuses({.half_width = 0});
    refuses({.half_height = -1});
    refuses({.half_height = nan});
    refuses({.point = {nan, 0, 0}});
    refuses({.frame = {.right = {0, 1, 0}}});
    refuses({.start_depth = nan});
    refuses({.cone_half_angle_deg = 61});
    refuses({.cone_half_angle_deg = nan});
}

} // namespace
} // namespace raywise
