// How times grow with the scene and shrink with threads.
#pragma once

#include "bench/class_bench.hpp"
#include "bench/rows.hpp"

#include <raywise/core/progress.hpp>
#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace raywise::app {

/// The recipes of a series: each name with 10^4, 10^5, ... up to `most` triangles.
[[nodiscard]] std::vector<std::string>
series_of(std::span<const std::string> names, std::size_t most);

/// For every recipe "name:count" that rows come from in more than one size: the growth from the
/// smallest to the largest, by name, class and peer.
[[nodiscard]] std::vector<GrowthRow> growth_of(std::span<const BenchRow> rows);

/// Building the global tree and a pencil grid, and tracing sun rays and bounces in batches, with
/// all threads of `machine.build` and with one, in turn. Nothing for one thread.
[[nodiscard]] std::vector<ThreadRow> bench_threads(
    const std::string& title,
    const Scene& scene,
    const WorkloadParams& workload,
    const Effort& effort,
    const Executor& all_threads,
    const Progress& progress
);

} // namespace raywise::app
