// End-point overlap: how much foreign surface lies inside the boxes of a tree. A ray that ends
// there opens boxes in vain. After [Aila13]; the form over recorded end points is ours.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <limits>
#include <span>

namespace raywise {

/// EPO: sum over the nodes of their cost (2 C_node, or C_prim per primitive) times the share of the
/// tree's surface that lies in the node's box without belonging to its subtree. In box tests, >= 0;
/// 0 for a tree of no area. `triangles[id]` must answer for every primitive of the tree. The same
/// for any number of threads. O(sum over the triangles of the boxes they reach into).
///
/// Of more than `most_triangles` (>= 1), every k-th by id stands for all: the ratio of the two sums
/// over that sample, with the least k that suffices.
[[nodiscard]] double measure_end_point_overlap(
    const Bvh& tree,
    const TriangleView& triangles,
    const CostConstants& constants = {},
    const Executor& executor = serial_executor(),
    std::size_t most_triangles = std::numeric_limits<std::size_t>::max()
);

/// Where a ray ended.
struct EndPoint {
    Vec3 point;
    PrimId prim = no_prim; ///< what it hit; no_prim, or a primitive of another tree: none of ours
};

/// The same with the mass of ray end points in place of surface: the share of the points that lie
/// in a node's box without belonging to its subtree. 0 for no points.
[[nodiscard]] double measure_end_point_overlap(
    const Bvh& tree,
    std::span<const EndPoint> points,
    const CostConstants& constants = {},
    const Executor& executor = serial_executor()
);

} // namespace raywise
