#include <raywise/optimize/depth_first.hpp>

#include <raywise/bvh/validate.hpp>

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace raywise {
namespace {

constexpr Aabb unit{{0, 0, 0}, {1, 1, 1}};

TEST(DepthFirst, EmptyTreeStaysEmpty) {
    EXPECT_TRUE(depth_first({}).is_empty());
}

TEST(DepthFirst, OrdersPairsAndSlotsAndDropsWhatIsNotReached) {
    // The right child's pair stands first, leaves list their slots backward, a pair is unused.
    Bvh tree;
    tree.nodes = {
        Node::inner(unit, NodeId{5}),
        Node::leaf(unit, 2, 1),
        Node::leaf(unit, 0, 2),
        Node::leaf(unit, 0, 1),
        Node::leaf(unit, 0, 1),
        Node::leaf(unit, 3, 1),
        Node::inner(unit, NodeId{1}),
    };
    tree.prims = {PrimId{4}, PrimId{5}, PrimId{6}, PrimId{7}};
    const Bvh sorted = depth_first(tree);
    EXPECT_EQ(find_fault(sorted, 8), std::nullopt);
    ASSERT_EQ(sorted.nodes.size(), 5U);
    EXPECT_EQ(sorted.prims, (std::vector<PrimId>{PrimId{7}, PrimId{6}, PrimId{4}, PrimId{5}}));
    EXPECT_TRUE(sorted[sorted.root().left()].is_leaf());
    EXPECT_EQ(sorted[sorted.root().right()].left(), NodeId{3});
}

} // namespace
} // namespace raywise
