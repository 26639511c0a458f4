// Visits the nodes of a tree from the root down.
#pragma once

#include <raywise/bvh/bvh.hpp>

#include <array>
#include <cstddef>

namespace raywise {

/// Calls `visit(NodeId, int level)` once for every node, parents before children, left before
/// right; the root has level 0. The tree must be valid (bvh/validate.hpp). No allocation.
template <class Visitor>
void walk(const Bvh& tree, Visitor&& visit) {
    struct Entry {
        NodeId id;
        int level;
    };

    if (tree.is_empty()) return;
    // One right child waits per level below the root.
    std::array<Entry, Bvh::max_depth + 1> pending{};
    std::size_t count = 0;
    pending[count++] = {NodeId{0}, 0};
    while (count > 0) {
        const Entry entry = pending[--count];
        visit(entry.id, entry.level);
        const Node& node = tree[entry.id];
        if (node.is_leaf()) continue;
        pending[count++] = {node.right(), entry.level + 1};
        pending[count++] = {node.left(), entry.level + 1};
    }
}

} // namespace raywise
