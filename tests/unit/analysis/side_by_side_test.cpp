#include <raywise/analysis/side_by_side.hpp>

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace raywise {
namespace {

TEST(SummarizeRounds, RatioIsTheMedianOfPairsNotThePairOfMedians) {
    const std::vector<double> first = {1, 10, 100};
    const std::vector<double> second = {3, 20, 100};
    const SideBySide summary = summarize_rounds(first, second);
    EXPECT_EQ(summary.rounds, 3);
    EXPECT_EQ(summary.first_ns, 10);
    EXPECT_EQ(summary.second_ns, 20);
    EXPECT_EQ(summary.ratio, 2);
    EXPECT_EQ(summary.spread, (2.5 - 1.5) / 2 / 2);
}

TEST(SummarizeRounds, ASlowMomentThatHitsBothOfAPairChangesNothing) {
    const SideBySide calm = summarize_rounds(std::vector<double>{2, 2}, std::vector<double>{6, 6});
    const SideBySide rough =
        summarize_rounds(std::vector<double>{2, 200}, std::vector<double>{6, 600});
    EXPECT_EQ(calm.ratio, rough.ratio);
    EXPECT_EQ(rough.spread, 0);
}

TEST(SummarizeRounds, NothingAndUnpairedTimesAreRefused) {
    EXPECT_THROW(static_cast<void>(summarize_rounds({}, {})), Error);
    EXPECT_THROW(
        static_cast<void>(summarize_rounds(std::vector<double>{1}, std::vector<double>{1, 2})),
        Error
    );
}

TEST(TimeSideBySide, WarmsUpThenTakesTurnsWithBothGoingFirst) {
    std::string calls;
    const SideBySide timed = time_side_by_side(
        [&] { calls += 'A'; },
        [&] { calls += 'B'; },
        {.min_rounds = 4, .max_rounds = 4, .budget_ms = 0}
    );
    EXPECT_EQ(calls, "ABABBAABBA");
    EXPECT_EQ(timed.rounds, 4);
}

TEST(TimeSideBySide, StopsAtTheBudgetButNotBeforeTheLeastRounds) {
    const auto nothing = [] {};
    EXPECT_EQ(
        time_side_by_side(nothing, nothing, {.min_rounds = 2, .max_rounds = 50, .budget_ms = 0})
            .rounds,
        2
    );
    EXPECT_EQ(
        time_side_by_side(nothing, nothing, {.min_rounds = 2, .max_rounds = 7, .budget_ms = 1e9})
            .rounds,
        7
    );
}

TEST(TimeSideBySide, ByThreadTimeWaitingCostsNothing) {
    volatile double sum = 0;
    const auto works = [&] {
        for (int i = 0; i < 200'000; ++i)
            sum = sum + 1;
    };
    const auto works_and_waits = [&] {
        works();
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    };
    const SideBySide by_thread = time_side_by_side(
        works, works_and_waits, {.min_rounds = 5, .max_rounds = 5, .timed_by = TimedBy::thread}
    );
    EXPECT_LT(by_thread.ratio, 3);
    EXPECT_GT(time_side_by_side(works, works_and_waits).ratio, 3);
}

TEST(TimeSideBySide, ParametersOutOfRangeAreRefused) {
    const auto nothing = [] {};
    EXPECT_THROW(static_cast<void>(time_side_by_side(nothing, nothing, {.min_rounds = 0})), Error);
    EXPECT_THROW(
        static_cast<void>(time_side_by_side(nothing, nothing, {.min_rounds = 5, .max_rounds = 4})),
        Error
    );
    EXPECT_THROW(static_cast<void>(time_side_by_side(nothing, nothing, {.budget_ms = -1})), Error);
}

} // namespace
} // namespace raywise
