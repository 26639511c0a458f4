// A wide tree for tests of what uses wide trees: no optimization, full and half-full nodes mixed.
#pragma once

#include "support/median_split.hpp"

#include <raywise/bvh/box_frame.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <array>
#include <cstddef>
#include <utility>

namespace raywise::test_support {

/// `levels` of the binary tree become one wide node.
class WideTreeMaker {
public:
    WideTreeMaker(const Bvh& tree, const TriangleView& triangles, std::size_t levels)
        : tree_(tree), triangles_(triangles), levels_(levels) {}

    [[nodiscard]] WideBvh make() {
        if (!tree_.is_empty()) {
            out_.box = tree_.root().box();
            add_node(NodeId{0});
        }
        return std::move(out_);
    }

private:
    std::size_t add_node(NodeId id) {
        std::array<NodeId, WideNode::width> slots{};
        std::size_t count = 0;
        expand(id, levels_, slots, count);
        const std::size_t at = out_.nodes.size();
        out_.nodes.emplace_back(WideNode{});
        for (std::size_t i = 0; i < WideNode::width; ++i)
            out_.nodes[at].clear(i);
        for (std::size_t i = 0; i < count; ++i) {
            const Node& node = tree_[slots[i]];
            const WideRef ref =
                node.is_leaf() ? WideRef::leaf(add_leaf(node)) : WideRef::node(add_node(slots[i]));
            out_.nodes[at].set(i, node.box(), ref);
        }
        return at;
    }

    void expand(
        NodeId id,
        std::size_t levels,
        std::array<NodeId, WideNode::width>& slots,
        std::size_t& count
    ) {
        const Node& node = tree_[id];
        if (node.is_leaf() || levels == 0) {
            slots[count++] = id;
            return;
        }
        expand(node.left(), levels - 1, slots, count);
        expand(node.right(), levels - 1, slots, count);
    }

    std::size_t add_leaf(const Node& leaf) {
        const std::size_t first = out_.blocks.size();
        const auto prims = tree_.prims_of(leaf);
        for (std::size_t i = 0; i < prims.size(); i += TriangleBlock::width) {
            TriangleBlock& block = out_.blocks.emplace_back(TriangleBlock{});
            block.is_last = i + TriangleBlock::width >= prims.size() ? 1 : 0;
            for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane) {
                if (i + lane >= prims.size()) {
                    block.clear(lane);
                    continue;
                }
                const PrimId prim = prims[i + lane];
                block.set(lane, triangles_[prim], prim);
                out_.vertex_bounds = unite(out_.vertex_bounds, bounds(triangles_[prim]));
            }
        }
        return first;
    }

    const Bvh& tree_;
    const TriangleView& triangles_;
    std::size_t levels_;
    WideBvh out_;
};

/// leaf_size >= 1, levels in [1, 3]. The triangles must be finite.
inline WideBvh
wide_tree(const TriangleView& triangles, std::size_t leaf_size = 4, std::size_t levels = 3) {
    const Bvh binary = median_split(triangles, leaf_size);
    return WideTreeMaker(binary, triangles, levels).make();
}

/// The same with boxes in another frame.
inline WideBvh
framed_tree(const TriangleView& triangles, const BoxFrame& frame, std::size_t leaf_size = 4) {
    const TriangleCopy mesh = to_frame(triangles, frame);
    const Bvh binary = median_split(mesh.view(), leaf_size);
    WideBvh tree = WideTreeMaker(binary, triangles, 3).make();
    tree.frame = frame;
    return tree;
}

} // namespace raywise::test_support
