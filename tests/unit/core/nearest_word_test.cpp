// Oracle: distances counted by hand.
#include <raywise/core/nearest_word.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace raywise {
namespace {

const std::vector<std::string> words = {"info", "build", "trace", "compare", "convert"};

TEST(NearestWord, FindsOneSlipOfEachKind) {
    EXPECT_EQ(nearest_word("compar", words), "compare");
    EXPECT_EQ(nearest_word("tracee", words), "trace");
    EXPECT_EQ(nearest_word("buyld", words), "build");
    EXPECT_EQ(nearest_word("convret", words), "convert") << "a swap is one slip";
}

TEST(NearestWord, OfAnotherWordIsNothing) {
    EXPECT_EQ(nearest_word("xylophone", words), std::nullopt);
    EXPECT_EQ(nearest_word(std::string(100'000, 'a'), words), std::nullopt);
    EXPECT_EQ(nearest_word("info", {}), std::nullopt);
}

TEST(NearestWord, FirstOfEqualsWins) {
    const std::vector<std::string> equals = {"ab", "ac"};
    EXPECT_EQ(nearest_word("ad", equals), "ab");
}

TEST(DidYouMean, IsEmptyWithoutASuggestion) {
    EXPECT_EQ(did_you_mean("inof", words), "; did you mean 'info'?");
    EXPECT_EQ(did_you_mean("xylophone", words), "");
}

} // namespace
} // namespace raywise
