// What all variants of an area are measured with and against.
#pragma once

#include "analysis/comparison/area_comparison.hpp"
#include "analysis/comparison/ray_sets.hpp"
#include "analysis/comparison/tree_run.hpp"

#include <raywise/analysis/statistics.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/area_id.hpp>
#include <raywise/toplevel/traced_tree.hpp>

#include <span>

namespace raywise::detail {

/// The area, its rays, and what they meet in the baseline's two trees.
struct AreaRuns {
    const AreaInput& input;
    InfluenceArea area; ///< as the run sees it
    RaySets sets;
    Accelerator baseline;
    TreeRun global;  ///< the global tree alone
    TreeRun local;   ///< the baseline's local tree alone
    RaySets shadows; ///< of the hits in the global tree
};

[[nodiscard]] AreaRuns run_baseline(const AreaInput& input);

/// The tree of the only area.
[[nodiscard]] inline const BinaryTree& local_tree_of(const Accelerator& accelerator) {
    return *accelerator.local(AreaId{0}).tree.binary();
}

[[nodiscard]] inline const BinaryTree& global_tree_of(const Accelerator& accelerator) {
    return *accelerator.global_tree().binary();
}

/// Of the pairs in which both sides cost something; {1, 0} when there is none.
[[nodiscard]] ConfidenceInterval
ratio_of(std::span<const double> candidate, std::span<const double> baseline);

} // namespace raywise::detail
