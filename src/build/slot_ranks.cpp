#include <raywise/build/slot_ranks.hpp>

#include <raywise/build/split.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace raywise {

std::size_t room_for(std::size_t count, double duplication) {
    // A tree over as many leaves has fewer than twice the nodes, and node ids have 32 bits.
    constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
    const auto wanted = static_cast<std::size_t>(duplication * static_cast<double>(count));
    return count >= most ? 0 : std::min(wanted, most - count);
}

Bvh close_ranks(std::vector<Node> nodes, std::span<const PrimId> slots, const Executor& executor) {
    const auto is_used = [](PrimId prim) { return prim != no_prim; };
    std::vector<std::size_t> before((slots.size() + prim_chunk - 1) / prim_chunk + 1, 0);
    executor.for_each_chunk(slots.size(), prim_chunk, [&](std::size_t begin, std::size_t end) {
        const auto part = slots.subspan(begin, end - begin);
        before[begin / prim_chunk + 1] =
            static_cast<std::size_t>(std::count_if(part.begin(), part.end(), is_used));
    });
    for (std::size_t c = 1; c < before.size(); ++c)
        before[c] += before[c - 1];

    Bvh tree;
    tree.prims.resize(before.back());
    std::vector<std::uint32_t> rank(slots.size());
    executor.for_each_chunk(slots.size(), prim_chunk, [&](std::size_t begin, std::size_t end) {
        std::size_t next = before[begin / prim_chunk];
        for (std::size_t i = begin; i < end; ++i) {
            rank[i] = static_cast<std::uint32_t>(next);
            if (is_used(slots[i])) tree.prims[next++] = slots[i];
        }
    });
    executor.for_each_chunk(nodes.size(), prim_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Node& node = nodes[i];
            if (node.is_leaf())
                nodes[i] = Node::leaf(
                    node.box(), rank[node.first()], static_cast<std::uint32_t>(node.count())
                );
        }
    });
    tree.nodes = std::move(nodes);
    return tree;
}

} // namespace raywise
