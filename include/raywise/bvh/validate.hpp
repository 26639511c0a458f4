// Whether arrays that claim to be a tree are one: what a reader of files must know before it
// traverses.
#pragma once

#include <raywise/bvh/bvh.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace raywise {

/// What is wrong with the structure of `tree`, or nothing: every node is reached exactly once and
/// stands after its parent; no node is deeper than Bvh::max_depth; boxes are finite, not empty, and
/// lie inside their parent's; leaves cover every slot exactly once; every primitive is below
/// `prim_count`. Safe on arbitrary arrays. O(nodes + slots).
[[nodiscard]] std::optional<std::string> find_fault(const Bvh& tree, std::size_t prim_count);

/// The same, and every leaf's box encloses the boxes of its primitives; boxes[i] is that of
/// primitive i. A primitive whose own box is empty or not finite is a fault when a leaf holds it.
[[nodiscard]] std::optional<std::string> find_fault(const Bvh& tree, std::span<const Aabb> boxes);

/// Throws Error with the reason when there is a fault.
void validate(const Bvh& tree, std::size_t prim_count);
void validate(const Bvh& tree, std::span<const Aabb> boxes);

} // namespace raywise
