// Parameters of the three-axis builders.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>

#include <cstddef>
#include <cstdint>

namespace raywise {

/// Parameters of build_binned and build_sweep.
struct BinnedParams {
    int bin_count = 32;              ///< most bins per axis, in [2, 256]; small nodes use fewer
    std::uint32_t max_leaf_size = 8; ///< primitives, >= 1; exceeded only where max_depth forces it
    int max_depth = Bvh::max_depth;  ///< of a leaf, in [1, 64], the root's being 0
    CostConstants cost{};            ///< both finite and > 0
};

/// Throws Error when a parameter is out of its range.
void check(const BinnedParams& params);

/// Bins per axis for a node of `count` primitives: min(bin_count, 4 + count / 8). Few primitives
/// have few planes between them, and each costs an evaluation. (32 or more bins at nodes of many
/// cost the same time; the tree gets up to 3 % better or worse, scene by scene.)
[[nodiscard]] constexpr int bins_for(std::size_t count, int bin_count) {
    const std::size_t wanted = 4 + count / 8;
    return wanted < static_cast<std::size_t>(bin_count) ? static_cast<int>(wanted) : bin_count;
}

/// Nodes of at most so many primitives are swept instead of binned: sorting them is cheaper than
/// setting up bins, and the split is the best there is.
inline constexpr std::size_t few_prims = 4;

} // namespace raywise
