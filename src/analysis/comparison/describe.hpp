// The columns of a comparison's row, group by group.
#pragma once

#include "analysis/comparison/area_runs.hpp"
#include "analysis/comparison/full_run.hpp"
#include "analysis/comparison/tree_run.hpp"

#include <raywise/analysis/comparison.hpp>
#include <raywise/toplevel/accelerator.hpp>

namespace raywise::detail {

/// Size, estimated costs and overlap of the row's local tree; what its build takes.
void describe_tree(ComparisonRow& row, const AreaRuns& runs, const Accelerator& accelerator);

/// What the local tree costs; `run` is its own. Needs the estimated costs.
void describe_costs(ComparisonRow& row, const AreaRuns& runs, const TreeRun& run);

/// The share of rays that the local tree has to answer alone to pay. Needs the real cost.
void describe_break_even(
    ComparisonRow& row,
    const AreaRuns& runs,
    const TreeRun& run,
    const FullRun& full
);

/// Where the rays of the area are answered.
void describe_service(AreaSummary& summary, const FullRun& full);

/// Times the local tree beside the baseline's, and the whole structure beside the global tree.
/// Needs the time of the build.
void time_variant(
    ComparisonRow& row,
    AreaSummary& summary,
    const AreaRuns& runs,
    const Accelerator& accelerator
);

} // namespace raywise::detail
