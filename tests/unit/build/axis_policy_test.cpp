#include <raywise/build/axis_policy.hpp>

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace raywise {
namespace {

constexpr Aabb unit{{0, 0, 0}, {1, 1, 1}};

std::array<int, 3> order(const AxisRanking& ranking) {
    return {ranking[0].axis, ranking[1].axis, ranking[2].axis};
}

float quality(const AxisRanking& ranking, int axis) {
    for (const RankedAxis& ranked : ranking)
        if (ranked.axis == axis) return ranked.quality;
    return -1;
}

AxisRanking facing(Vec3d direction) {
    return FacingAxis(SameDirection{direction})(unit);
}

TEST(RankAxes, SortsByQualityAndKeepsTiesInOrder) {
    EXPECT_EQ(order(rank_axes(1, 2, 3)), (std::array{2, 1, 0}));
    EXPECT_EQ(order(rank_axes(2, 3, 1)), (std::array{1, 0, 2}));
    EXPECT_EQ(order(rank_axes(1, 1, 1)), (std::array{0, 1, 2}));
    EXPECT_EQ(order(rank_axes(0, 1, 1)), (std::array{1, 2, 0}));
    EXPECT_EQ(order(rank_axes(1, 0, 1)), (std::array{0, 2, 1}));
    EXPECT_EQ(order(rank_axes(0, 1, 0)), (std::array{1, 0, 2}));
}

TEST(LongestAxis, QualityIsTheShareOfTheLongestSide) {
    const AxisRanking ranking = LongestAxis{}({{0, 0, 0}, {1, 4, 2}});
    EXPECT_EQ(order(ranking), (std::array{1, 2, 0}));
    EXPECT_EQ(quality(ranking, 0), 0.25F);
    EXPECT_EQ(quality(ranking, 1), 1);
    EXPECT_EQ(quality(ranking, 2), 0.5F);
}

TEST(LongestAxis, EveryAxisOfAPointIsAsGood) {
    EXPECT_EQ(LongestAxis{}({{1, 1, 1}, {1, 1, 1}}), rank_axes(1, 1, 1));
}

TEST(FacingAxis, ValuesOfSection42) {
    const AxisRanking parallel = facing({1, 0, 0});
    EXPECT_EQ(order(parallel), (std::array{1, 2, 0}));
    EXPECT_EQ(quality(parallel, 0), 0);
    EXPECT_EQ(quality(parallel, 1), 1);
    const AxisRanking tilted = facing({-0.966, 0, 0.259});
    EXPECT_NEAR(quality(tilted, 0), 0.045, 0.001);
    EXPECT_NEAR(quality(tilted, 1), 1, 0);
    EXPECT_NEAR(quality(tilted, 2), 0.622, 0.001);
    EXPECT_EQ(order(tilted), (std::array{1, 2, 0}));
    EXPECT_FLOAT_EQ(quality(facing({-3, 0, 3}), 2), 0.25F);
    EXPECT_FLOAT_EQ(quality(facing({2, 2, 2}), 1), 4.F / 9.F);
}

TEST(FacingAxis, NoDirectionPrefersNoAxis) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(facing({0, 0, 0}), rank_axes(1, 1, 1));
    EXPECT_EQ(facing({nan, 0, 1}), rank_axes(1, 1, 1));
}

TEST(AxisFilter, LetsThroughWhatReachesTheThreshold) {
    const AxisFilter filter{.policy = FacingAxis(SameDirection{{1, 0, 0}}), .threshold = 0.4F};
    EXPECT_EQ(wanted_axes(filter, unit), (std::array{false, true, true}));
    EXPECT_EQ(wanted_axes(AxisFilter<>{}, unit), (std::array{true, true, true}));
}

} // namespace
} // namespace raywise
