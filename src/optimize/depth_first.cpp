#include <raywise/optimize/depth_first.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/walk.hpp>
#include <raywise/core/ids.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise {

Bvh depth_first(const Bvh& tree) {
    Bvh result;
    if (tree.is_empty()) return result;
    result.nodes.resize(tree.nodes.size());
    result.prims.reserve(tree.prims.size());

    // A walk opens inner nodes in the order in which their pairs shall stand.
    std::vector<std::uint32_t> place(tree.nodes.size(), 0);
    std::size_t next = 1;
    walk(tree, [&](NodeId id, int) {
        const Node& node = tree[id];
        Node& target = result.nodes[place[to_index(id)]];
        if (!node.is_leaf()) {
            target = Node::inner(node.box(), to_node(next));
            place[to_index(node.left())] = static_cast<std::uint32_t>(next);
            place[to_index(node.right())] = static_cast<std::uint32_t>(next + 1);
            next += 2;
            return;
        }
        const auto first = static_cast<std::uint32_t>(result.prims.size());
        target = Node::leaf(node.box(), first, static_cast<std::uint32_t>(node.count()));
        for (const PrimId prim : tree.prims_of(node))
            result.prims.push_back(prim);
    });
    result.nodes.resize(next);
    return result;
}

} // namespace raywise
