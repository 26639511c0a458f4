// What every reader of files owes to malformed input: a refusal of one short line, and no crash.
#pragma once

#include "scratch_folder.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace raywise::testing_io {

/// The message with which `read` refuses, or nullopt when it accepts. Any exception but Error, and
/// any message that is not one line of at most 300 bytes, fails the test.
template <class Read>
std::optional<std::string> refusal_of(const Read& read) {
    try {
        read();
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_LE(message.size(), 300U) << message;
        EXPECT_GT(message.size(), 0U);
        const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
        EXPECT_TRUE(std::none_of(message.begin(), message.end(), is_control)) << message;
        return message;
    }
    return std::nullopt;
}

/// Changes one to four places of `bytes`: a bit, a byte, a run copied, removed or inserted, a cut.
inline std::string mutated(std::string bytes, std::uint64_t seed, std::uint64_t item) {
    Rng rng(seed, item);
    const auto place = [&] { return static_cast<std::size_t>(rng.below(bytes.size() + 1)); };
    const std::uint64_t changes = 1 + rng.below(4);
    for (std::uint64_t change = 0; change < changes && !bytes.empty(); ++change) {
        const std::size_t at = std::min(place(), bytes.size() - 1);
        const std::size_t run = std::min<std::size_t>(1 + rng.below(8), bytes.size() - at);
        switch (rng.below(7)) {
        case 0:
            bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1U << rng.below(8)));
            break;
        case 1:
            bytes[at] = static_cast<char>(rng.below(256));
            break;
        case 2:
            bytes.erase(at, run);
            break;
        case 3:
            bytes.insert(place(), bytes.substr(at, run));
            break;
        case 4:
            bytes[at] = "0123456789-+.eE,/ \n\r\0[]{}\"\\"[rng.below(28)];
            break;
        case 5:
            bytes.replace(at, run, std::string(run, '\xFF'));
            break;
        default:
            bytes.resize(at);
            break;
        }
    }
    return bytes;
}

/// Reads `count` mutations of the bytes; how many were refused.
template <class Read>
std::size_t refused_mutations(std::string_view bytes, std::uint64_t count, const Read& read) {
    std::size_t refused = 0;
    for (std::uint64_t item = 0; item < count; ++item) {
        const std::string changed = mutated(std::string(bytes), 7, item);
        if (refusal_of([&] { read(changed); })) ++refused;
    }
    return refused;
}

} // namespace raywise::testing_io
