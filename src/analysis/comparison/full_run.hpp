// Sets of rays through the whole structure: an area's tree, then the global one where that cannot
// answer alone.
#pragma once

#include "analysis/comparison/ray_sets.hpp"
#include "analysis/comparison/tree_run.hpp"

#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/toplevel/accelerator.hpp>

#include <cstdint>
#include <vector>

namespace raywise::detail {

/// What became of rays.
struct FullRun {
    double cost = 0; ///< of all rays
    std::uint64_t rays = 0;
    std::uint64_t hits = 0;
    std::uint64_t answered = 0; ///< without the global tree
    std::uint64_t local_hits = 0;
    std::uint64_t searched = 0;  ///< in the local tree
    std::uint64_t continued = 0; ///< in both
    std::uint64_t continued_hits = 0;
    double local_cost = 0;        ///< of all local searches
    double continuation_cost = 0; ///< of all global searches after a local one
    double global_alone_cost = 0; ///< of the rays that the local tree was asked about
    std::uint64_t wrong = 0;      ///< hits that are not the global tree's

    FullRun& operator+=(const FullRun& other);
};

/// One run for each set; `global` is that of the global tree alone over the same sets.
[[nodiscard]] std::vector<FullRun> run_full(
    const Accelerator& accelerator,
    const RaySets& sets,
    const TreeRun& global,
    const CostConstants& constants,
    const Executor& executor
);

/// Any-hit costs of the whole structure and of its global tree alone, by set.
struct ShadowRun {
    std::vector<double> full;
    std::vector<double> global;
    std::vector<std::uint64_t> wrong; ///< answers that differ
};

[[nodiscard]] ShadowRun run_shadows(
    const Accelerator& accelerator,
    const RaySets& shadows,
    const CostConstants& constants,
    const Executor& executor
);

} // namespace raywise::detail
