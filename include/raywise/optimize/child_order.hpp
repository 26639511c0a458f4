// Which child of a node stands first, for traversals that open children in the order of memory.
// Occlusion order after [Ize11] and [Nah14]; ours: any hit measure, and an opacity of leaves from
// their triangles.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/optimize/depth_first.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace raywise {

/// What a ray that meets a node can expect there.
struct NodeOutlook {
    double cost = 0;    ///< of searching it for any hit, in units of the cost constants
    double opacity = 0; ///< probability that it holds a hit, in [0, 1]
};

/// Left becomes the child whose center is less far along `direction`; equals stay. For rays that
/// all run about that way, near children then come first without a comparison. O(nodes).
[[nodiscard]] Bvh order_front_to_back(Bvh tree, Vec3d direction);

/// Share of a triangle's box that the triangle itself shows to uniform lines: its area over half
/// the surface of its box, in [0, 1]; 0 for a degenerate one.
[[nodiscard]] double box_coverage(const Triangle& triangle);

/// Outlook of both children, `left_share` and `right_share` of whose parent's rays meet them, when
/// the left is opened first and the right only by rays that got through.
[[nodiscard]] NodeOutlook outlook_in_order(
    const NodeOutlook& left,
    double left_share,
    const NodeOutlook& right,
    double right_share,
    const CostConstants& cost
);

/// The outlook of every node of a valid tree for any-hit rays of the measure that open the left
/// child first. A leaf is as opaque as its triangles' shares of it, summed: their coverage times
/// the mass of the part of their boxes inside the leaf. O(nodes + slots) evaluations.
template <HitMeasure M>
[[nodiscard]] std::vector<NodeOutlook> any_hit_outlook(
    const Bvh& tree,
    const TriangleView& triangles,
    const M& measure,
    const CostConstants& cost = {}
);

/// Left becomes the child that finds more hits per cost: the order of least expected cost for
/// any-hit rays that open children as they stand [Ize11]; equals stay. O(nodes + slots).
template <HitMeasure M>
[[nodiscard]] Bvh order_for_any_hit(
    Bvh tree,
    const TriangleView& triangles,
    const M& measure,
    const CostConstants& cost = {}
);

} // namespace raywise

#include <raywise/optimize/child_order.inl.hpp> // IWYU pragma: export
