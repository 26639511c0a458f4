// Counter-based random numbers: a value is a function of (seed, stream, index), whatever ran before
// it. After [Steele14].
#pragma once

#include <cstdint>

namespace raywise {

/// The finalizer of SplitMix64: a bijection of 64-bit words in which every input bit reaches every
/// output bit. [Steele14]
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t word) {
    word = (word ^ (word >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    word = (word ^ (word >> 27U)) * 0x94D049BB133111EBULL;
    return word ^ (word >> 31U);
}

/// One stream of random numbers. Give every item its own stream (`Rng(seed, item)`): results then
/// do not depend on the number of threads. The conversions to real numbers are exact and portable,
/// unlike the standard distributions.
class Rng {
public:
    constexpr explicit Rng(std::uint64_t seed, std::uint64_t stream = 0)
        : state_(mix_bits(mix_bits(seed + golden) ^ (stream * 0xD1342543DE82EF95ULL + golden))) {}

    [[nodiscard]] constexpr std::uint64_t bits() { return mix_bits(state_ += golden); }

    /// Uniform on the multiples of 2^-24 in [0, 1).
    [[nodiscard]] constexpr float uniform() { return static_cast<float>(bits() >> 40U) * 0x1p-24F; }

    /// Uniform on the multiples of 2^-53 in [0, 1).
    [[nodiscard]] constexpr double uniform_double() {
        return static_cast<double>(bits() >> 11U) * 0x1p-53;
    }

    /// Uniform in [lo, hi); `hi` itself can appear by rounding.
    [[nodiscard]] constexpr double uniform(double lo, double hi) {
        return lo + (hi - lo) * uniform_double();
    }

    /// Uniform in [0, count), count > 0; the bias is below count / 2^64.
    [[nodiscard]] constexpr std::uint64_t below(std::uint64_t count) {
        __extension__ using Wide = unsigned __int128;
        return static_cast<std::uint64_t>((static_cast<Wide>(bits()) * count) >> 64U);
    }

private:
    static constexpr std::uint64_t golden = 0x9E3779B97F4A7C15ULL;

    std::uint64_t state_;
};

} // namespace raywise
