// Puts the nodes of a tree back into the order of memory that traversals like.
#pragma once

#include <raywise/bvh/bvh.hpp>

namespace raywise {

/// The same tree with its pairs in depth-first order, left before right, and its slots in the order
/// of its leaves. Links of `tree` may lead anywhere, as long as every node is reached once; nodes
/// that the root does not reach are dropped. The depth must be at most Bvh::max_depth. O(nodes +
/// slots).
[[nodiscard]] Bvh depth_first(const Bvh& tree);

} // namespace raywise
