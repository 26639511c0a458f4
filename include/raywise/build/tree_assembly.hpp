// Where the nodes of a parallel build go, so that the finished array does not depend on who built
// what.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/large_buffer.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace raywise {

/// Room for the nodes of a tree over `count` primitives before they are packed. The descendants of
/// a node over the primitive slots [first, last) may use node slots 2 first + 1 to 2 last - 2: two
/// subtrees never meet, whoever builds them. Untouched room costs address space only.
class NodeRoom {
public:
    explicit NodeRoom(std::size_t count);

    /// 2 first + 1: where the descendants of a node over slots from `first` start.
    [[nodiscard]] static std::size_t first_slot(std::size_t first) { return 2 * first + 1; }

    /// The pair between the rooms of two children that meet at `middle`.
    [[nodiscard]] static std::size_t pair_slot(std::size_t middle) { return 2 * middle - 1; }

    void put(std::size_t slot, const Node& node) { std::construct_at(nodes_.get() + slot, node); }

    [[nodiscard]] const Node& operator[](std::size_t slot) const { return nodes_.get()[slot]; }

private:
    LargeBuffer<Node> nodes_;
};

/// Node slots [begin, end) of a room, in use without gaps.
struct NodeBlock {
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// Blocks in the order in which their nodes shall stand.
using NodeBlocks = std::vector<NodeBlock>;

/// The nodes of the root (slot 0) and the blocks side by side, links adjusted. A link must lead to
/// a place inside its own block or to the first slot of another.
[[nodiscard]] std::vector<Node>
pack_nodes(const NodeRoom& room, const NodeBlocks& blocks, const Executor& executor);

} // namespace raywise
