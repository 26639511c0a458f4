// The mass of every node of a tree, for measures that are dear to ask.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <cstddef>
#include <vector>

namespace raywise {

/// Sets the masses of a node and of all below it, narrowing on the way down.
template <NarrowableMeasure M>
void weigh_below(
    const Bvh& tree,
    NodeId id,
    const M& measure,
    float* masses,
    int parallel_levels,
    const Executor& executor
) {
    const Node& node = tree[id];
    masses[to_index(id)] = static_cast<float>(measure(node.box()));
    if (node.is_leaf()) return;
    const M inside = measure.narrowed(node.box());
    const auto descend = [&](NodeId child) {
        weigh_below(tree, child, inside, masses, parallel_levels - 1, executor);
    };
    if (parallel_levels > 0) {
        executor.invoke([&] { descend(node.left()); }, [&] { descend(node.right()); });
    } else {
        descend(node.left());
        descend(node.right());
    }
}

/// measure(box) of every node, by place. A measure that can be narrowed is, on the way down:
/// counted rays then cost what meets a node, not all of them. `tree` must be valid. The same for
/// any executor.
template <HitMeasure M>
[[nodiscard]] std::vector<float>
node_masses(const Bvh& tree, const M& measure, const Executor& executor = serial_executor()) {
    std::vector<float> masses(tree.nodes.size());
    if (tree.is_empty()) return masses;
    if constexpr (NarrowableMeasure<M>) {
        constexpr int parallel_levels = 8;
        weigh_below(tree, NodeId{0}, measure, masses.data(), parallel_levels, executor);
    } else {
        constexpr std::size_t chunk = 4096;
        executor.for_each_chunk(masses.size(), chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                masses[i] = static_cast<float>(measure(tree.nodes[i].box()));
        });
    }
    return masses;
}

} // namespace raywise
