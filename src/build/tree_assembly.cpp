#include <raywise/build/tree_assembly.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace raywise {

namespace {

struct Move {
    NodeBlock from;
    std::size_t to = 0;
};

} // namespace

NodeRoom::NodeRoom(std::size_t count) : nodes_(2 * count) {}

std::vector<Node>
pack_nodes(const NodeRoom& room, const NodeBlocks& blocks, const Executor& executor) {
    std::vector<Move> moves;
    moves.reserve(blocks.size() + 1);
    moves.push_back({{0, 1}, 0});
    std::size_t total = 1;
    for (const NodeBlock& block : blocks) {
        moves.push_back({block, total});
        total += block.end - block.begin;
    }
    std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) {
        return a.from.begin < b.from.begin;
    });

    std::vector<Node> nodes(total);
    const auto target_of = [&](std::size_t slot) {
        const auto after = std::upper_bound(
            moves.begin(),
            moves.end(),
            slot,
            [](std::size_t value, const Move& move) { return value < move.from.begin; }
        );
        const Move& move = *(after - 1);
        return move.to + (slot - move.from.begin);
    };
    executor.for_each_chunk(moves.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t m = begin; m < end; ++m) {
            const NodeBlock from = moves[m].from;
            for (std::size_t slot = from.begin; slot < from.end; ++slot) {
                const Node& node = room[slot];
                std::size_t to = moves[m].to + (slot - from.begin);
                if (node.is_leaf()) {
                    nodes[to] = node;
                    continue;
                }
                const std::size_t left = to_index(node.left());
                const bool is_near = from.begin <= left && left < from.end;
                const std::size_t target =
                    is_near ? moves[m].to + (left - from.begin) : target_of(left);
                nodes[to] = Node::inner(node.box(), to_node(target));
            }
        }
    });
    return nodes;
}

} // namespace raywise
