// Bodies of estimated_cost.hpp.
#pragma once

#include <raywise/analysis/estimated_cost.hpp>

#include <cstddef>
#include <vector>

namespace raywise {

namespace detail {

template <HitMeasure M>
void add_cost_below(
    const Bvh& tree,
    NodeId id,
    const M& measure,
    const CostConstants& constants,
    EstimatedCost& cost
) {
    const Node& node = tree[id];
    const auto mass = static_cast<double>(static_cast<float>(measure(node.box())));
    if (node.is_leaf()) {
        cost.leaves += mass * constants.prim * static_cast<double>(node.count());
        return;
    }
    cost.inner += mass * 2 * constants.node;
    if constexpr (NarrowableMeasure<M>) {
        const M inside = measure.narrowed(node.box());
        add_cost_below(tree, node.left(), inside, constants, cost);
        add_cost_below(tree, node.right(), inside, constants, cost);
    } else {
        add_cost_below(tree, node.left(), measure, constants, cost);
        add_cost_below(tree, node.right(), measure, constants, cost);
    }
}

} // namespace detail

template <HitMeasure M>
EstimatedCost estimate_cost(
    const Bvh& tree,
    const M& measure,
    Normalization normalization,
    const CostConstants& constants
) {
    EstimatedCost cost;
    if (tree.is_empty()) return cost;
    detail::add_cost_below(tree, NodeId{0}, measure, constants, cost);
    if (normalization == Normalization::absolute) return cost;
    const auto root = static_cast<double>(static_cast<float>(measure(tree.root().box())));
    if (!(root > 0)) return {};
    return {.inner = cost.inner / root, .leaves = cost.leaves / root};
}

} // namespace raywise
