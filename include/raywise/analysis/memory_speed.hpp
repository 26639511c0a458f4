// How fast this machine's memory is at a given size of data: what no structure of that size can
// beat.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raywise {

/// Nanoseconds of a load whose address the one before it gave, at random cache lines of `bytes`
/// (at least 4096; less counts as that) on large pages where the system offers them: the least of
/// several runs. Runs for a few tens of milliseconds and takes that much memory.
[[nodiscard]] double measure_load_ns(std::size_t bytes, std::uint64_t seed = 1);

/// Billions of bytes per second of a pass in order over so many, one thread: the best of several.
[[nodiscard]] double measure_stream_gb_per_s(std::size_t bytes);

} // namespace raywise
