// The shape of a tree in numbers (section 6.1 of the method).
#pragma once

#include <raywise/bvh/bvh.hpp>

#include <cstddef>
#include <map>

namespace raywise {

/// Counts of one tree. All zero for an empty tree.
struct TreeStatistics {
    std::size_t nodes = 0;
    std::size_t leaves = 0;
    std::size_t references = 0;   ///< primitive slots; more than primitives when some are split
    int max_depth = 0;            ///< of a node, the root's being 0
    double mean_leaf_depth = 0;   ///< over leaves, unweighted
    std::size_t largest_leaf = 0; ///< primitives
    std::map<std::size_t, std::size_t> leaf_sizes; ///< primitives in a leaf -> number of leaves
    std::size_t bytes = 0;                         ///< of the nodes and the primitive slots
};

/// The tree must be valid. O(nodes log(distinct leaf sizes)).
[[nodiscard]] TreeStatistics measure_tree(const Bvh& tree);

} // namespace raywise
