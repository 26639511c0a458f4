#include <raywise/analysis/break_even.hpp>

#include <gtest/gtest.h>

namespace raywise {
namespace {

TEST(BreakEvenHitFraction, MakesThePairCostExactlyTheGlobalStructure) {
    const TwoLevelCosts costs{.local = 40, .continuation = 80, .global = 90};
    const auto share = break_even_hit_fraction(costs);
    ASSERT_TRUE(share);
    EXPECT_NEAR(two_level_cost(costs, *share), costs.global, 1e-12);
    EXPECT_LT(two_level_cost(costs, *share + 0.1), costs.global);
    EXPECT_GT(two_level_cost(costs, *share - 0.1), costs.global);
}

TEST(BreakEvenHitFraction, HasTheSignOfTheSpreadsheetNotOfTheText) {
    // Published run: Random100, plane, parallel, PAH+SPFH (docs/reproduction.md).
    const TwoLevelCosts costs{.local = 12.9652, .continuation = 18.7582, .global = 19.7492};
    EXPECT_NEAR(*break_even_hit_fraction(costs), 0.63835, 1e-4);
}

TEST(BreakEvenHitFraction, AboveOneMeansItCanNeverPay) {
    const TwoLevelCosts costs{.local = 100, .continuation = 50, .global = 90};
    EXPECT_GT(*break_even_hit_fraction(costs), 1);
    EXPECT_GT(two_level_cost(costs, 1), costs.global);
}

TEST(BreakEvenHitFraction, IsNoQuestionWhenContinuingIsFree) {
    EXPECT_FALSE(break_even_hit_fraction({.local = 1, .continuation = 0, .global = 2}));
    EXPECT_FALSE(break_even_hit_fraction_of_restart({.local = 1, .continuation = 1, .global = 0}));
}

TEST(BreakEvenHitFraction, OfARestartIsTheCaseOfAFullGlobalQuery) {
    const TwoLevelCosts costs{.local = 30, .continuation = 75, .global = 75};
    EXPECT_DOUBLE_EQ(*break_even_hit_fraction_of_restart(costs), *break_even_hit_fraction(costs));
}

TEST(BreakEvenRays, DivideTheExtraBuildByTheSavingPerRay) {
    EXPECT_EQ(break_even_rays(1000, 10, 5), 200);
    EXPECT_EQ(break_even_rays(0, 10, 10), 0);
    EXPECT_EQ(break_even_rays(-5, 10, 9), 0);
    EXPECT_FALSE(break_even_rays(1000, 5, 10));
    EXPECT_FALSE(break_even_rays(1000, 5, 5));
    EXPECT_FALSE(break_even_rays(-5, 5, 10));
}

} // namespace
} // namespace raywise
