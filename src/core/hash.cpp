#include <raywise/core/hash.hpp>

#include <fmt/format.h>
#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace raywise {

std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed) {
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::string hex(std::uint64_t value) {
    return fmt::format("{:016x}", value);
}

} // namespace raywise
