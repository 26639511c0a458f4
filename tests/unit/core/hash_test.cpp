#include <raywise/core/hash.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>

namespace raywise {
namespace {

TEST(Hash, OfNothingIsThePublishedXxh3Value) {
    EXPECT_EQ(
        hex(hash_bytes({})), "2d06800538d394c2"
    ); // XXH3_64bits of the empty input, xxHash specification
}

TEST(Hash, ChangesWithAnyBit) {
    std::array<std::uint32_t, 4> words{1, 2, 3, 4};
    const auto hash = [&] { return hash_elements(std::span<const std::uint32_t>(words)); };
    const std::uint64_t before = hash();
    for (auto& word : words)
        for (std::uint32_t bit = 1; bit != 0; bit <<= 1U) {
            word ^= bit;
            EXPECT_NE(hash(), before);
            word ^= bit;
        }
    EXPECT_EQ(hash(), before);
}

} // namespace
} // namespace raywise
