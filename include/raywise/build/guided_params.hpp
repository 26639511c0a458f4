// Parameters of the guided builder.
#pragma once

#include <raywise/bvh/cost_constants.hpp>

#include <cstdint>
#include <optional>

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
    /// Mass of all rays, so that p = m / total_mass; nothing: the mass of the root, or 1
    /// where it has none. > 0
    std::optional<double> total_mass = std::nullopt;
    CostConstants cost{};  ///< both finite and > 0; `node` is not used in faithful mode
    bool faithful = false; ///< reproduce G1 to G9, and so the thesis's numbers
};

/// Throws Error when a parameter is out of its range.
void check(const GuidedParams& params);

} // namespace raywise
