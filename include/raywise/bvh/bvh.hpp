// The tree as plain data: 32-byte nodes in one array, primitive ids in leaf order in another. No
// heuristics.
#pragma once

#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raywise {

/// A box and either two children, which stand side by side, or a range of primitive slots.
class alignas(32) Node {
public:
    Node() = default;

    /// count >= 1.
    [[nodiscard]] static Node leaf(const Aabb& box, std::uint32_t first, std::uint32_t count) {
        assert(count >= 1);
        return {box, first, count};
    }

    /// Children at `left` and `left` + 1.
    [[nodiscard]] static Node inner(const Aabb& box, NodeId left) {
        return {box, static_cast<std::uint32_t>(left), 0};
    }

    [[nodiscard]] const Aabb& box() const { return box_; }

    [[nodiscard]] bool is_leaf() const { return count_ != 0; }

    [[nodiscard]] NodeId left() const {
        assert(!is_leaf());
        return static_cast<NodeId>(first_);
    }

    [[nodiscard]] NodeId right() const {
        assert(!is_leaf());
        return static_cast<NodeId>(first_ + 1);
    }

    /// First slot of a leaf in `Bvh::prims`.
    [[nodiscard]] std::size_t first() const {
        assert(is_leaf());
        return first_;
    }

    /// Number of slots of a leaf.
    [[nodiscard]] std::size_t count() const {
        assert(is_leaf());
        return count_;
    }

    void set_box(const Aabb& box) { box_ = box; }

private:
    Node(const Aabb& box, std::uint32_t first, std::uint32_t count)
        : box_(box), first_(first), count_(count) {}

    Aabb box_;
    std::uint32_t first_ = 0;
    std::uint32_t count_ = 0; ///< 0: inner node
};

static_assert(sizeof(Node) == 32, "two nodes share a 64-byte cache line");

/// A binary tree. nodes[0] is the root; children come after their parent, in depth-first order of
/// pairs; an empty tree has no nodes. Every node's box encloses those of its children and
/// primitives; the depth is at most `max_depth`.
struct Bvh {
    static constexpr int max_depth =
        64; ///< of a node, the root's being 0: traversal stacks of this size suffice

    std::vector<Node> nodes;
    std::vector<PrimId>
        prims; ///< the primitive in each slot; a primitive may stand in several slots

    [[nodiscard]] bool is_empty() const { return nodes.empty(); }

    [[nodiscard]] const Node& operator[](NodeId id) const { return nodes[to_index(id)]; }

    [[nodiscard]] const Node& root() const { return nodes.front(); }

    /// The primitives of a leaf.
    [[nodiscard]] std::span<const PrimId> prims_of(const Node& leaf) const {
        return std::span(prims).subspan(leaf.first(), leaf.count());
    }
};

} // namespace raywise
