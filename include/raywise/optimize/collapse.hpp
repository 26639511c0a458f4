// From a binary tree to the wide one that queries run on: which of its nodes survive. After
// [Wald08], [Ylitie17]. Ours: any hit measure instead of the surface area.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/large_buffer.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/optimize/child_order.hpp>
#include <raywise/optimize/node_masses.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise {

struct CollapseParams {
    double block_cost = 0.5; ///< testing four triangles, in openings of a wide node; > 0
    std::uint32_t max_leaf_size =
        8; ///< triangles, in [1, 64]; exceeded only by leaves of the binary tree
};

/// Throws Error when a parameter is out of its range.
void check(const CollapseParams& params);

namespace detail {

/// Of the nodes of a binary tree, by their place.
struct NodeWeights {
    const float* mass;    ///< the measure of the box
    NodeOutlook* outlook; ///< of any-hit rays; of leaves on entry, of all nodes on return
};

/// collapse when the nodes' weights are known.
[[nodiscard]] WideBvh collapse_weighed(
    const Bvh& tree,
    const TriangleView& triangles,
    const NodeWeights& weights,
    const CollapseParams& params,
    const Executor& executor
);

} // namespace detail

/// The wide tree of least expected cost, sum of m(node) over inner nodes plus block_cost m(leaf)
/// per block over leaves, among those that keep some of the nodes of `tree`, by dynamic
/// programming: the finer its leaves, the more there is to choose from (max_leaf_size 2 gave 4 %
/// faster closest hits than 8). Slots stand by rising promise: any-hit rays try the last first,
/// which stops the most rays for its cost (NodeOutlook). A triangle stands at most once per
/// leaf. Primitive i of `tree` is triangle i of `triangles`; the boxes are those of `tree`; where
/// they are in another frame than the world, set `frame` of the result. No primitives: an empty
/// tree. O(n) time, 80 bytes of temporary memory per node. The same bytes for any executor. Throws
/// Error for parameters out of range and above WideRef::max_nodes or max_blocks.
template <HitMeasure M>
[[nodiscard]] WideBvh collapse(
    const Bvh& tree,
    const TriangleView& triangles,
    const M& measure,
    const CollapseParams& params = {},
    const Executor& executor = serial_executor()
) {
    const std::vector<float> masses = node_masses(tree, measure, executor);
    const LargeBuffer<NodeOutlook> outlooks(tree.nodes.size());
    constexpr std::size_t chunk = 4096;
    executor.for_each_chunk(tree.nodes.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Node& node = tree.nodes[i];
            if (node.is_leaf()) outlooks[i] = leaf_outlook(tree, node, triangles, measure, {});
        }
    });
    return detail::collapse_weighed(
        tree, triangles, {masses.data(), outlooks.get()}, params, executor
    );
}

} // namespace raywise
