#include <raywise/core/rng.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>

namespace raywise {
namespace {

TEST(Rng, SameSeedAndStreamGiveTheSameNumbersEverywhere) {
    // Recorded once: a change of these breaks every published result.
    Rng rng(1, 2);
    const std::array<std::uint64_t, 3> expected{
        0xCB137D8F0E457CA7ULL, 0x0E1F60594EE810CFULL, 0x104ED155649406CBULL
    };
    for (const std::uint64_t value : expected)
        EXPECT_EQ(rng.bits(), value);
}

TEST(Rng, NeighboringStreamsAndSeedsShareNoNumber) {
    std::set<std::uint64_t> seen;
    for (std::uint64_t seed = 0; seed < 10; ++seed)
        for (std::uint64_t stream = 0; stream < 100; ++stream) {
            Rng rng(seed, stream);
            for (int i = 0; i < 10; ++i)
                seen.insert(rng.bits());
        }
    EXPECT_EQ(seen.size(), 10'000U);
}

TEST(Rng, UniformNumbersAreBelowOneWithTheRightMoments) {
    constexpr int count = 100'000;
    double sum = 0;
    double squares = 0;
    Rng rng(7);
    for (int i = 0; i < count; ++i) {
        const double x = static_cast<double>(rng.uniform());
        ASSERT_GE(x, 0.0);
        ASSERT_LT(x, 1.0);
        sum += x;
        squares += x * x;
    }
    // Standard errors of the mean and of the mean square: sqrt(1/12 n), sqrt(4/45 n); five of them.
    EXPECT_NEAR(sum / count, 1.0 / 2, 5 * std::sqrt(1.0 / 12 / count));
    EXPECT_NEAR(squares / count, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / count));
}

TEST(Rng, BelowReachesEveryValueAboutEquallyOften) {
    constexpr int count = 70'000;
    std::array<int, 7> tally{};
    Rng rng(3);
    for (int i = 0; i < count; ++i)
        ++tally.at(rng.below(7));
    for (const int n : tally)
        EXPECT_NEAR(n, count / 7, 5 * std::sqrt(count * (1.0 / 7) * (6.0 / 7)));
    EXPECT_EQ(Rng(1).below(1), 0U);
}

} // namespace
} // namespace raywise
