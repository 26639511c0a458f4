// Bodies of overlap.hpp.
#pragma once

#include <raywise/analysis/overlap.hpp>
#include <raywise/bvh/walk.hpp>

namespace raywise {

template <class Mass>
    requires std::is_invocable_r_v<PairMass, const Mass&, const Aabb&, const Aabb&>
SiblingOverlap measure_overlap(const Bvh& tree, const Mass& mass) {
    SiblingOverlap overlap;
    walk(tree, [&](NodeId id, int level) {
        const Node& node = tree[id];
        if (node.is_leaf()) return;
        overlap.add(level, mass(tree[node.left()].box(), tree[node.right()].box()));
    });
    return overlap;
}

} // namespace raywise
