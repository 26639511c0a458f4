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
            const NodeId left = node.left();
            const NodeId right = node.right();
            const auto touch_left = slab(tree[left].box(), Real(limit));
            const auto touch_right = slab(tree[right].box(), Real(limit));
            // Branches on purpose: a guessed child is already being loaded while its box is still
            // being compared, which a computed index cannot offer.
            if (touch_left.hit && touch_right.hit) {
                // The far child waits: the near one's hit may cull it.
                const bool left_first = touch_left.entry <= touch_right.entry;
                stack[height++] = left_first ? Pending{right, touch_right.entry}
                                             : Pending{left, touch_left.entry};
                current = left_first ? left : right;
                continue;
            }
            if (touch_left.hit || touch_right.hit) {
                current = touch_left.hit ? left : right;
                continue;
            }
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
