// The one loop behind all ordered queries: near child first, pruned by what is still wanted.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray_box.hpp>
#include <raywise/trace/observer.hpp>

#include <array>
#include <cstddef>

namespace raywise {

/// Opens the leaves that the ray may hit at t <= `limit`, nearer siblings first. `open_leaf(node,
/// limit)` tests a leaf's triangles; it may lower `limit`, and returns whether to go on. Pruning is
/// not strict: a box entered at exactly `limit` is opened, so that ties find the lowest id. `ray`
/// must be valid. The stack is fixed: one entry per level above a node.
template <class Real, TraceObserver Observer, class OpenLeaf>
void traverse_slab(
    const Bvh& tree,
    const BasicSlab<Real>& slab,
    float limit,
    Observer& seen,
    OpenLeaf&& open_leaf
) {
    struct Pending {
        NodeId node;
        Real entry;
    };

    std::array<Pending, Bvh::max_depth + 1> stack; // NOLINT(*-member-init): written before read
    std::size_t height = 0;

    NodeId current{0};
    seen.box_tests(1);
    if (!slab(tree.root().box(), Real(limit)).hit) return;

    for (;;) {
        const Node& node = tree[current];
        if (!node.is_leaf()) {
            seen.inner(current);
            seen.box_tests(2);
            const std::size_t left = to_index(node.left());
            const auto touch_left = slab(tree.nodes[left].box(), Real(limit));
            const auto touch_right = slab(tree.nodes[left + 1].box(), Real(limit));
            // Arithmetic on the answers instead of branches on them: which child is nearer is
            // anybody's guess. The far one waits, since the near one's hit may cull it.
            const bool right_is_nearer = touch_right.entry < touch_left.entry;
            const bool right_first = touch_right.hit & (!touch_left.hit | right_is_nearer);
            stack[height] = {
                to_node(left + (right_first ? 0 : 1)),
                right_first ? touch_left.entry : touch_right.entry
            };
            height += static_cast<std::size_t>(touch_left.hit & touch_right.hit);
            current = to_node(left + (right_first ? 1 : 0));
            if (touch_left.hit | touch_right.hit) continue;
        } else {
            seen.leaf(current);
            if (!open_leaf(node, limit)) return;
        }
        const Real reach = BasicSlab<Real>::reach(Real(limit));
        do {
            if (height == 0) return;
            --height;
        } while (stack[height].entry > reach);
        current = stack[height].node;
    }
}

/// traverse_slab with the slab test that suits the ray. An empty tree and a ray that is not
/// `is_valid` open nothing and test nothing.
template <TraceObserver Observer, class OpenLeaf>
void traverse(const Bvh& tree, const Ray& ray, Observer& seen, OpenLeaf&& open_leaf) {
    if (tree.is_empty() || !is_valid(ray)) return;
    if (needs_wide_slab(ray)) [[unlikely]]
        traverse_slab(tree, WideSlab(ray), ray.t_max, seen, open_leaf);
    else
        traverse_slab(tree, Slab(ray), ray.t_max, seen, open_leaf);
}

} // namespace raywise
