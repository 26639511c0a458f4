// Content hashes: what a file holds and what a result was computed from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace raywise {

/// XXH3, 64 bits, of the bytes; the same on every machine of the same byte order.
[[nodiscard]] std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed = 0);

/// Of the elements' bytes; element types without padding only.
template <class T>
[[nodiscard]] std::uint64_t hash_elements(std::span<const T> elements, std::uint64_t seed = 0) {
    return hash_bytes(std::as_bytes(elements), seed);
}

/// Sixteen lower-case hexadecimal digits.
[[nodiscard]] std::string hex(std::uint64_t value);

} // namespace raywise
