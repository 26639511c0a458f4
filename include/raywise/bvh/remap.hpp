// Renames primitives: a tree over a subset becomes a tree over the whole.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/wide_bvh.hpp>

#include <span>

namespace raywise {

/// Primitive i becomes ids[i]: after a build over the boxes of a subset, `ids` lists the subset.
/// Throws Error when a primitive of the tree is not below ids.size(); the tree is then unchanged.
void remap_prims(Bvh& tree, std::span<const PrimId> ids);
void remap_prims(WideBvh& tree, std::span<const PrimId> ids);

} // namespace raywise
