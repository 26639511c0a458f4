// New boxes for an old tree: primitives moved, the structure stays.
#pragma once

#include <raywise/bvh/bvh.hpp>

#include <span>

namespace raywise {

/// Recomputes every node's box from the leaves up; boxes[i] is that of primitive i. The tree must
/// be valid, and every primitive of the tree below boxes.size(). O(nodes + slots).
void refit(Bvh& tree, std::span<const Aabb> boxes);

} // namespace raywise
