// The registry of the long checks: one file per check, one line here, one line in main.cpp.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/core/function_ref.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace raywise::verify {

struct Options {
    std::uint64_t rays = 10'000'000; ///< at least this many
    std::uint64_t seed = 1;
    int threads = 0; ///< 0: all
};

struct Outcome {
    std::uint64_t rays = 0;
    std::uint64_t wrong = 0;
};

/// closest_hit, any_hit and all_hits over trees and by brute force, against rational arithmetic, on
/// small scenes of which a third is degenerate.
[[nodiscard]] Outcome check_hits(const Options& options);

/// Rays from inside closed meshes toward vertices, edges and anywhere hit something.
[[nodiscard]] Outcome check_leaks(const Options& options);

/// No slab test refuses a box that holds an exact hit.
[[nodiscard]] Outcome check_slabs(const Options& options);

/// The accelerator with random influence areas against one plain tree.
[[nodiscard]] Outcome check_areas(const Options& options);

/// Runs `scene(index)` for indices 0, 1, ... in parallel until its outcomes sum up to
/// `options.rays`. Every index is one scene with a random stream of its own, so a failure can be
/// repeated whatever the number of threads.
inline Outcome for_scenes(
    const Options& options,
    std::uint64_t rays_per_scene,
    FunctionRef<Outcome(std::uint64_t index)> scene
) {
    const auto scenes =
        static_cast<std::size_t>((options.rays + rays_per_scene - 1) / rays_per_scene);
    std::atomic<std::uint64_t> rays = 0;
    std::atomic<std::uint64_t> wrong = 0;
    const Executor executor(options.threads);
    constexpr std::size_t chunk = 8;
    executor.for_each_chunk(scenes, chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Outcome outcome = scene(i);
            rays += outcome.rays;
            wrong += outcome.wrong;
        }
    });
    return {rays, wrong};
}

} // namespace raywise::verify
