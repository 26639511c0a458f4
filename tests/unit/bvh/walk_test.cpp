#include <raywise/bvh/walk.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace raywise {
namespace {

constexpr Aabb unit{{0, 0, 0}, {1, 1, 1}};

TEST(Walk, VisitsNothingOfAnEmptyTree) {
    int visits = 0;
    walk(Bvh{}, [&](NodeId, int) { ++visits; });
    EXPECT_EQ(visits, 0);
}

TEST(Walk, VisitsEveryNodeOnceInDepthFirstOrderWithItsLevel) {
    const Bvh tree{
        {Node::inner(unit, NodeId{1}),
         Node::inner(unit, NodeId{3}),
         Node::leaf(unit, 2, 1),
         Node::leaf(unit, 0, 1),
         Node::leaf(unit, 1, 1)},
        {PrimId{0}, PrimId{1}, PrimId{2}}
    };
    std::vector<std::pair<std::size_t, int>> seen;
    walk(tree, [&](NodeId id, int level) { seen.emplace_back(to_index(id), level); });
    const std::vector<std::pair<std::size_t, int>> expected{{0, 0}, {1, 1}, {3, 2}, {4, 2}, {2, 1}};
    EXPECT_EQ(seen, expected);
}

TEST(Walk, ReachesTheDeepestLevelThatATreeMayHave) {
    Bvh tree;
    tree.nodes.push_back(Node::leaf(unit, 0, 1));
    std::size_t open = 0;
    for (int level = 1; level <= Bvh::max_depth; ++level) {
        const std::size_t pair = tree.nodes.size();
        tree.nodes.resize(pair + 2, Node::leaf(unit, 0, 1));
        tree.nodes[open] = Node::inner(unit, to_node(pair));
        open = pair; // left children: a right one waits at every level
    }
    int deepest = 0;
    std::size_t visits = 0;
    walk(tree, [&](NodeId, int level) {
        deepest = std::max(deepest, level);
        ++visits;
    });
    EXPECT_EQ(deepest, Bvh::max_depth);
    EXPECT_EQ(visits, tree.nodes.size());
}

} // namespace
} // namespace raywise
