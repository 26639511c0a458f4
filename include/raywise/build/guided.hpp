// The decision-tree builder of the thesis: axes are ranked, and most are never tried. [Falcone24]
// Ours: its faults G1 to G9 (section 4.5 of the method) are corrected unless asked for.
#pragma once

#include <raywise/build/axis_policy.hpp>
#include <raywise/build/guided_params.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <span>

namespace raywise {

/// What the build did. [Falcone24] reports these per inner node.
struct GuidedReport {
    std::size_t inner_nodes = 0;
    std::size_t axes_tried = 0;
    std::size_t cost_evaluations = 0; ///< of one candidate child
    std::size_t forced_fallbacks = 0; ///< axes below the quality threshold tried all the same
    std::size_t stop_checks = 0;
};

struct GuidedTree {
    Bvh tree;
    GuidedReport report;
};

/// A tree over `boxes` whose primitive i has the box boxes[i] and the centroid centroids[i] (the
/// thesis: the mean of the three vertices). Boxes as for build_binned, centroids finite and of the
/// same number; throws Error otherwise. Ties go to the lower plane (faithful) or the more balanced
/// split. Faithful leaves may have any size. Serial; O(n (axes + levels) + nodes x bins).
template <HitMeasure M, AxisPolicy P>
[[nodiscard]] GuidedTree build_guided(
    std::span<const Aabb> boxes,
    std::span<const Vec3> centroids,
    const M& measure,
    const P& policy,
    const GuidedParams& params = {}
);

} // namespace raywise

#include <raywise/build/guided.inl.hpp> // IWYU pragma: export
