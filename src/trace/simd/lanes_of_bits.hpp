// Which lanes a mask of eight selects.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace raywise::simd {

/// By mask: the numbers of its set bits, rising, then zeros.
inline constexpr auto lanes_of_bits = [] {
    alignas(8) std::array<std::array<std::uint8_t, 8>, 256> lanes{};
    for (std::size_t mask = 0; mask < lanes.size(); ++mask) {
        std::size_t count = 0;
        for (std::uint8_t bit = 0; bit < 8; ++bit)
            if ((mask >> bit & 1U) != 0) lanes[mask][count++] = bit;
    }
    return lanes;
}();

} // namespace raywise::simd
