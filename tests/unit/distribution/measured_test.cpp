#include <raywise/distribution/measured.hpp>

#include "support/statistics.hpp"

#include <raywise/core/error.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/uniform.hpp>
#include <raywise/geometry/ray_box.hpp>

#include <gtest/gtest.h>

#include <limits>

namespace raywise {
namespace {

const Aabb unit{{0, 0, 0}, {1, 1, 1}};

Aabb random_box(Rng& rng) {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        const float a = rng.uniform();
        const float b = rng.uniform();
        box.lo[axis] = std::min(a, b);
        box.hi[axis] = std::max(a, b);
    }
    return box;
}

MeasuredParams chords(std::size_t count, double shrinkage) {
    const UniformDistribution uniform(unit);
    MeasuredParams params{.rays = {}, .bounds = unit, .shrinkage = shrinkage};
    for (std::uint64_t i = 0; i < count; ++i) {
        Rng rng(1, i);
        params.rays.push_back({uniform.sample(rng), 1});
    }
    return params;
}

TEST(MeasuredMeasure, CountsTheWeightsOfTheRaysThatMeetTheBox) {
    const Ray down{.origin = {0.5F, 0.5F, 2}, .direction = {0, 0, -1}};
    const Ray aside{.origin = {5, 5, 2}, .direction = {0, 0, -1}};
    Ray too_short = down;
    too_short.t_max = 0.5F;
    const MeasuredDistribution rays(
        {.rays = {{down, 1}, {aside, 2}, {too_short, 5}}, .bounds = unit, .shrinkage = 0}
    );
    EXPECT_FLOAT_EQ(rays.measure()(unit), 1.0F / 8);
    EXPECT_FLOAT_EQ(rays.measure()({{0, 0, 1}, {1, 1, 1.5F}}), 6.0F / 8) << "ends at a face";
}

TEST(MeasuredMeasure, ShrinksTowardTheSurfaceMeasure) {
    MeasuredParams params = chords(10, 30);
    params.rays.assign(10, {{.origin = {9, 9, 9}, .direction = {1, 0, 0}}, 1});
    const MeasuredDistribution rays(params);
    const Aabb unseen{{0, 0, 0}, {1, 1, 0}};
    // Nothing counted; the plate has a third of the cube's surface.
    EXPECT_FLOAT_EQ(rays.measure()(unseen), 30.0F / 3 / 40);
}

TEST(MeasuredMeasure, ManyUniformChordsGiveTheSurfaceMeasure) {
    constexpr std::size_t count = 20'000;
    const MeasuredDistribution rays(chords(count, 0));
    const UniformMeasure surface(unit);
    for (std::uint64_t i = 0; i < 50; ++i) {
        Rng rng(2, i);
        const Aabb box = random_box(rng);
        const auto share = static_cast<double>(rays.measure()(box));
        const double error = std::sqrt(0.25 / count);
        EXPECT_TRUE(testing::agrees({share, error}, static_cast<double>(surface(box))));
    }
}

TEST(MeasuredMeasure, NarrowedCountsTheSameInsideTheBoxFromFewerRays) {
    const MeasuredDistribution rays(chords(2000, 3));
    const MeasuredMeasure all = rays.measure();
    for (std::uint64_t i = 0; i < 20; ++i) {
        Rng rng(3, i);
        const Aabb outer = random_box(rng);
        const MeasuredMeasure narrowed = all.narrowed(outer);
        EXPECT_LT(narrowed.ray_count(), all.ray_count());
        const MeasuredMeasure twice = narrowed.narrowed(outer);
        EXPECT_EQ(twice.ray_count(), narrowed.ray_count());
        EXPECT_EQ(narrowed(outer), all(outer));
        const Aabb inner = intersect(outer, random_box(rng));
        EXPECT_EQ(narrowed(inner), all(inner));
    }
    EXPECT_EQ(all.narrowed(Aabb{}).ray_count(), 0U);
}

TEST(MeasuredMeasure, NeverShrinksAsTheBoxGrows) {
    const MeasuredMeasure measure = MeasuredDistribution(chords(500, 1)).measure();
    for (std::uint64_t i = 0; i < 500; ++i) {
        Rng rng(4, i);
        const Aabb outer = random_box(rng);
        const Aabb inner = intersect(outer, random_box(rng));
        EXPECT_LE(measure(inner), measure(outer));
    }
}

TEST(MeasuredMeasure, SharedIsTheWeightThatMeetsBoth) {
    const MeasuredParams params = chords(300, 0);
    const MeasuredMeasure measure = MeasuredDistribution(params).measure();
    Rng rng(5);
    const Aabb a = random_box(rng);
    const Aabb b = random_box(rng);
    double both = 0;
    for (const RecordedRay& recorded : params.rays)
        if (intersect(recorded.ray, a) && intersect(recorded.ray, b)) both += 1;
    EXPECT_DOUBLE_EQ(measure.shared(a, b), both / 300);
}

TEST(MeasuredDistribution, DrawsRaysByTheirWeights) {
    const Ray rare{.origin = {0.5F, 0.5F, 2}, .direction = {0, 0, -1}};
    const Ray never{.origin = {0.5F, 0.5F, 3}, .direction = {0, 0, -1}};
    const Ray often{.origin = {0.5F, 0.5F, 4}, .direction = {0, 0, -1}};
    const MeasuredDistribution rays(
        {.rays = {{rare, 1}, {never, 0}, {often, 3}}, .bounds = unit, .shrinkage = 0}
    );
    EXPECT_DOUBLE_EQ(rays.density(rare), 0.25);
    EXPECT_DOUBLE_EQ(rays.density(never), 0);
    EXPECT_DOUBLE_EQ(rays.density(often), 0.75);
    testing::RunningMean drawn_often;
    for (std::uint64_t i = 0; i < 10'000; ++i) {
        Rng rng(6, i);
        const Ray ray = rays.sample(rng);
        ASSERT_FALSE(ray.origin == never.origin);
        drawn_often.add(ray.origin == often.origin ? 1 : 0);
    }
    EXPECT_TRUE(testing::agrees(drawn_often, 0.75));
}

TEST(MeasuredDistribution, DirectionAtABoxIsTheMeanOfItsRays) {
    const Ray down{.origin = {0.5F, 0.5F, 2}, .direction = {0, 0, -7}};
    const Ray along{.origin = {-1, 5, 0.5F}, .direction = {2, 0, 0}};
    const MeasuredDistribution rays({.rays = {{down, 1}, {along, 2}}, .bounds = unit});
    EXPECT_EQ(rays.direction_at(unit), (Vec3d{0, 0, 1}));
    EXPECT_EQ(rays.direction_at({{8, 8, 8}, {9, 9, 9}}), (Vec3d{2, 0, 1})) << "no ray: all of them";
}

TEST(MeasuredDistribution, RefusesWhatIsOutOfRange) {
    const RecordedRay good{{.origin = {0, 0, 0}, .direction = {1, 0, 0}}, 1};
    const auto refuses = [](const MeasuredParams& params) {
        EXPECT_THROW(MeasuredDistribution{params}, Error);
    };
    RecordedRay still = good;
    still.ray.direction = {};
    RecordedRay negative = good;
    negative.weight = -1;
    RecordedRay weightless = good;
    weightless.weight = 0;
    refuses({.rays = {}, .bounds = unit});
    refuses({.rays = {good}, .bounds = {}});
    refuses({.rays = {good}, .bounds = {{0, 0, 0}, {1, 0, 0}}});
    refuses({.rays = {good}, .bounds = unit, .shrinkage = -1});
    refuses({.rays = {good, still}, .bounds = unit});
    refuses({.rays = {good, negative}, .bounds = unit});
    refuses({.rays = {weightless}, .bounds = unit});
    EXPECT_NO_THROW(MeasuredDistribution({.rays = {good, weightless}, .bounds = unit}));
}

} // namespace
} // namespace raywise
