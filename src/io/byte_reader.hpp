// Reads numbers of either byte order out of bytes, never beyond their end.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace raywise::io_detail {

/// The number that stands at `bytes[at]` in the given byte order. The caller has checked that
/// at + sizeof(T) <= bytes.size().
template <class T>
[[nodiscard]] T
load(std::string_view bytes, std::size_t at, std::endian order = std::endian::little) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes.data() + at, sizeof(T));
    if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

/// Appends the number in little-endian order.
template <class T>
void append(std::string& bytes, T value) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if constexpr (std::endian::native != std::endian::little) std::reverse(raw.begin(), raw.end());
    bytes.append(raw.data(), raw.size());
}

} // namespace raywise::io_detail
