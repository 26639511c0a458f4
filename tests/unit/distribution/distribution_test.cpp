#include <raywise/distribution/distribution.hpp>

#include <raywise/core/error.hpp>
#include <raywise/distribution/monte_carlo.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace raywise {
namespace {

const Aabb unit{{0, 0, 0}, {1, 1, 1}};
const Aabb part{{0.25F, 0.25F, 0.25F}, {0.5F, 0.5F, 1}};

TEST(MeasureOf, UniformIsThePlainSurfaceAreaAndTheOthersAreAbsolute) {
    const Distribution uniform = UniformDistribution(unit);
    EXPECT_EQ(evaluate(measure_of(uniform), part), half_area(part));
    EXPECT_NEAR(hit_probability(uniform, part), static_cast<double>(half_area(part)) / 3, 1e-7);
    const Distribution parallel = ParallelDistribution({});
    EXPECT_NEAR(static_cast<double>(evaluate(measure_of(parallel), part)), 0.25 * 0.25 / 4, 1e-7);
    EXPECT_EQ(evaluate(measure_of(parallel), Aabb{}), 0);
}

TEST(MeasureOf, ThesisModeReachesTheRadialMeasure) {
    const Distribution lamp =
        RadialDistribution({.eye = {0.5, 0.5, 0.5}, .window = RadialWindow{}});
    EXPECT_EQ(evaluate(measure_of(lamp), unit), 1);
    EXPECT_EQ(evaluate(measure_of(lamp, MeasureMode::thesis), unit), 0);
}

TEST(Distribution, NamesItsKind) {
    EXPECT_EQ(kind_name(UniformDistribution(unit)), "uniform");
    EXPECT_EQ(kind_name(ParallelDistribution({})), "parallel");
    EXPECT_EQ(kind_name(RadialDistribution({.window = RadialWindow{}})), "radial");
    const MeasuredDistribution record({.rays = {{{.direction = {1, 0, 0}}, 1}}, .bounds = unit});
    EXPECT_EQ(kind_name(record), "measured");
}

TEST(Distribution, DirectionAtABoxIsThatOfTheAlternative) {
    EXPECT_EQ(direction_at(UniformDistribution(unit), part), (Vec3d{1, 1, 1}));
    EXPECT_EQ(direction_at(ParallelDistribution({}), part), (Vec3d{0, 0, 1}));
}

TEST(UniformDistribution, RefusesBoundsWithoutSurface) {
    EXPECT_THROW(UniformDistribution(Aabb{}), Error);
    EXPECT_THROW(UniformDistribution({{0, 0, 0}, {1, 0, 0}}), Error);
    EXPECT_THROW(UniformDistribution({{0, 0, 0}, {1, 1, INFINITY}}), Error);
    EXPECT_THROW(UniformDistribution({{0, 0, 0}, {1, 1, NAN}}), Error);
    EXPECT_NO_THROW(UniformDistribution({{0, 0, 0}, {1, 1, 0}}));
}

TEST(UniformDistribution, ChordsStayInTheBounds) {
    const UniformDistribution chords(unit);
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng rng(1, i);
        const Ray ray = chords.sample(rng);
        for (const float t : {0.0F, ray.t_max}) {
            const Vec3 at = point_at(ray, t);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GE(at[axis], -1e-6F);
                EXPECT_LE(at[axis], 1 + 1e-6F);
            }
        }
    }
}

TEST(CountShare, OfACertainAndAnImpossibleBoxHasAnErrorAboveZero) {
    const ParallelDistribution rays({});
    const ShareEstimate all = count_share(rays, {{-9, -9, 1}, {9, 9, 2}}, {.samples = 100});
    EXPECT_EQ(all.share, 1);
    EXPECT_GT(all.standard_error, 0);
    const ShareEstimate none = count_share(rays, {{-9, -9, -2}, {9, 9, -1}}, {.samples = 100});
    EXPECT_EQ(none.share, 0);
    EXPECT_GT(none.standard_error, 0);
    EXPECT_THROW((void)count_share(rays, unit, {.samples = 0}), Error);
}

TEST(CountShare, ErrorIsWhatRepetitionsShow) {
    const ParallelDistribution rays({});
    const Aabb third{{-1, -1, 1}, {-1.0F / 3, 1, 2}};
    double squares = 0;
    double stated = 0;
    constexpr int repetitions = 400;
    for (int i = 0; i < repetitions; ++i) {
        const auto estimate =
            count_share(rays, third, {.samples = 200, .seed = static_cast<std::uint64_t>(i)});
        squares += std::pow(estimate.share - 1.0 / 3, 2);
        stated = estimate.standard_error;
    }
    EXPECT_NEAR(std::sqrt(squares / repetitions), stated, 0.1 * stated);
}

} // namespace
} // namespace raywise
