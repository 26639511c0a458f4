// Bodies of child_order.hpp.
#pragma once

#include <raywise/optimize/child_order.hpp>

namespace raywise {

/// Share of the rays of a whole that meet a part of it, in [0, 1]; of a whole without mass: all.
[[nodiscard]] inline double share_of(float part, float whole) {
    if (!(whole > 0)) return 1;
    return std::min(1.0, static_cast<double>(part) / static_cast<double>(whole));
}

template <HitMeasure M>
[[nodiscard]] NodeOutlook leaf_outlook(
    const Bvh& tree,
    const Node& leaf,
    const TriangleView& triangles,
    const M& measure,
    const CostConstants& cost
) {
    const auto whole = static_cast<float>(measure(leaf.box()));
    double clear = 1;
    for (const PrimId id : tree.prims_of(leaf)) {
        const Triangle triangle = triangles[id];
        const auto part = static_cast<float>(measure(intersect(bounds(triangle), leaf.box())));
        clear *= 1 - box_coverage(triangle) * share_of(part, whole);
    }
    return {cost.prim * static_cast<double>(leaf.count()), 1 - clear};
}

/// Opens nodes from the last to the first, children before parents; `may_swap(left, left_share,
/// right, right_share)` tells whether to exchange two children.
template <HitMeasure M, class MaySwap>
std::vector<NodeOutlook> gather_outlook(
    Bvh& tree,
    const TriangleView& triangles,
    const M& measure,
    const CostConstants& cost,
    const MaySwap& may_swap
) {
    std::vector<NodeOutlook> all(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        const Node& node = tree.nodes[i];
        if (node.is_leaf()) {
            all[i] = leaf_outlook(tree, node, triangles, measure, cost);
            continue;
        }
        const std::size_t left = to_index(node.left());
        const std::size_t right = to_index(node.right());
        const auto whole = static_cast<float>(measure(node.box()));
        const auto share = [&](std::size_t child) {
            return share_of(static_cast<float>(measure(tree.nodes[child].box())), whole);
        };
        double left_share = share(left);
        double right_share = share(right);
        if (may_swap(all[left], all[right])) {
            std::swap(tree.nodes[left], tree.nodes[right]);
            std::swap(all[left], all[right]);
            std::swap(left_share, right_share);
        }
        all[i] = outlook_in_order(all[left], left_share, all[right], right_share, cost);
    }
    return all;
}

template <HitMeasure M>
std::vector<NodeOutlook> any_hit_outlook(
    const Bvh& tree,
    const TriangleView& triangles,
    const M& measure,
    const CostConstants& cost
) {
    Bvh copy = tree;
    return gather_outlook(
        copy, triangles, measure, cost, [](const NodeOutlook&, const NodeOutlook&) { return false; }
    );
}

template <HitMeasure M>
Bvh order_for_any_hit(
    Bvh tree,
    const TriangleView& triangles,
    const M& measure,
    const CostConstants& cost
) {
    // First a, then b costs a + (1 - opacity of a) b: a goes first when opacity / cost is greater.
    static_cast<void>(gather_outlook(
        tree,
        triangles,
        measure,
        cost,
        [](const NodeOutlook& left, const NodeOutlook& right) {
            return right.opacity * left.cost > left.opacity * right.cost;
        }
    ));
    return depth_first(tree);
}

} // namespace raywise
