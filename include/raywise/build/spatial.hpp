// Top-down build that may cut triangles in two where their boxes overlap too much. After [Stich09];
// ours: any hit measure, room for cuts shared out along the way down, so that the tree is the same
// for any number of threads.
#pragma once

#include <raywise/build/spatial_params.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/triangle_view.hpp>

namespace raywise {

/// A tree over `triangles` in which a triangle may stand in several leaves, each holding a part of
/// it: every point of a triangle is in the box of a leaf that lists the triangle, but a leaf's box
/// need not hold the triangle's box. Object splits as build_binned; beside them, where their halves
/// overlap, planes that cut triangles compete by the same price. A triangle stays whole where that
/// is not dearer. A child's share of the room left for further references is its share of the
/// references.
///
/// Coordinates must be finite and in [-2^60, 2^60]; at most 2^31 - 1 triangles and references
/// together. Throws Error otherwise. No triangles: an empty tree. O(n log n) time for splits that
/// share evenly; 130 bytes per possible reference of temporary memory. The same bytes for any
/// executor.
template <HitMeasure M>
[[nodiscard]] Bvh build_spatial(
    const TriangleView& triangles,
    const M& measure,
    const SpatialParams& params = {},
    const Executor& executor = serial_executor()
);

} // namespace raywise

#include <raywise/build/spatial.inl.hpp> // IWYU pragma: export
