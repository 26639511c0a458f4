// The expected cost of a ray in a finished tree, under any hit measure. After [Goldsmith87,
// MacDonald90] for the surface area, [Falcone24] for the projected area.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <cstdint>

namespace raywise {

/// What a hit probability is a share of.
enum class Normalization : std::uint8_t {
    conditional, ///< the rays that hit the root: divides by the root's measure
    absolute,    ///< all emitted rays: takes the measure as the probability it is
};

/// Expected cost per ray, in box tests, of an unordered traversal without pruning: every box that
/// is hit is opened.
struct EstimatedCost {
    double inner = 0;  ///< box tests: 2 C_node per inner node, times its hit probability
    double leaves = 0; ///< triangle tests: C_prim per primitive, times its leaf's

    [[nodiscard]] double total() const { return inner + leaves; }
};

/// Sum over the nodes of hit probability times cost. 0 for an empty tree, and for a root of measure
/// 0: no ray gets that far. The surface measure is no probability: use `conditional` with it. With
/// `absolute` the measure must be a probability, as those of the distributions are; the result is
/// then the mean counted cost (`measure_real_cost`) of the distribution's own rays. The tree must
/// be valid. One evaluation per node; a measure that can be narrowed is, on the way down.
template <HitMeasure M>
[[nodiscard]] EstimatedCost estimate_cost(
    const Bvh& tree,
    const M& measure,
    Normalization normalization,
    const CostConstants& constants = {}
);

/// |real - estimated| / estimated, a fraction; 0 when both are 0, +inf when only the estimate is.
[[nodiscard]] double estimate_error(double real, double estimated);

} // namespace raywise

#include <raywise/analysis/estimated_cost.inl.hpp> // IWYU pragma: export
