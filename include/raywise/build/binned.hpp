// Top-down build that looks for the cheapest of a few planes on all three axes. After [Wald07].
// Ours: any hit measure instead of the surface area, one metric for all axes, bounded depth.
#pragma once

#include <raywise/build/axis_policy.hpp>
#include <raywise/build/binned_params.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <span>

namespace raywise {

/// A tree over `boxes`; primitive i has the box boxes[i]. Minimizes the expected cost of an
/// unpruned traversal plane by plane: 2 node + prim (m(L) n_L + m(R) n_R) / m(parent), against n
/// prim for a leaf. Ties go to the more balanced split, then the lower axis, then the lower plane.
/// Where the measure sees nothing of a node, its surface area decides, and the sum of its sides
/// where it has none. A node of more than max_leaf_size primitives that no plane separates is
/// halved. A measure that can be narrowed is, on the way down. The filter may skip axes.
///
/// Every box must be valid (not empty) with coordinates in [-2^60, 2^60]; at most 2^31 - 1 of them.
/// Throws Error otherwise. No boxes: an empty tree. O(n log n) time for splits that share evenly,
/// O(max_depth n) at worst; 128 bytes per box of temporary memory. The same bytes for any executor.
template <HitMeasure M, AxisPolicy P = AllAxes>
[[nodiscard]] Bvh build_binned(
    std::span<const Aabb> boxes,
    const M& measure,
    const BinnedParams& params = {},
    const Executor& executor = serial_executor(),
    const AxisFilter<P>& filter = {}
);

} // namespace raywise

#include <raywise/build/binned.inl.hpp> // IWYU pragma: export
