// The decision-tree builder of the thesis: axes are ranked, and most are never tried. [Falcone24]
// Ours: its faults G1 to G9 (section 4.5 of the method) are corrected unless asked for.
#pragma once

#include <raywise/build/axis_policy.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace raywise {

/// Parameters of the guided builder; the defaults are the thesis's where it has them.
struct GuidedParams {
    int bin_count = 40;             ///< bins per axis, in [3, 4096]
    float quality_threshold = 0.4F; ///< an axis of less quality is tried only if need be; [0, 1]
    double acceptable_ratio = 1.3;  ///< of children's to parent's mass: no forced axis below; >= 0
    double excellent_ratio = 0.9;   ///< no further axis at or below; >= 0
    int max_levels = 100;           ///< nodes on a path, >= 1; at most max_depth + 1 are made
    int max_measured_levels = 100;  ///< below this level surface area and longest axes decide; >= 0
    double max_leaf_cost = 0;       ///< a node that costs less is a leaf; >= 0
    double max_leaf_probability = 0; ///< a node that is met less often is a leaf; >= 0
    double max_leaf_area = 0;        ///< a node of less surface area is a leaf; >= 0
    /// Corrected: most primitives of a leaf. Faithful: a node of fewer is a leaf (G8). >= 1
    std::uint32_t max_leaf_size = 2;
    /// Mass of all rays, so that p = m / total_mass; nothing: the mass of the root. > 0
    std::optional<double> total_mass;
    CostConstants cost{};  ///< both finite and > 0; `node` is not used in faithful mode
    bool faithful = false; ///< reproduce G1 to G9, and so the thesis's numbers
};

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
