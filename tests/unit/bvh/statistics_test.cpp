#include <raywise/bvh/statistics.hpp>

#include <gtest/gtest.h>

#include <map>

namespace raywise {
namespace {

constexpr Aabb unit{{0, 0, 0}, {1, 1, 1}};

TEST(MeasureTree, EmptyTreeIsAllZero) {
    const TreeStatistics shape = measure_tree({});
    EXPECT_EQ(shape.nodes, 0U);
    EXPECT_EQ(shape.leaves, 0U);
    EXPECT_EQ(shape.mean_leaf_depth, 0);
    EXPECT_TRUE(shape.leaf_sizes.empty());
    EXPECT_EQ(shape.bytes, 0U);
}

TEST(MeasureTree, CountsOfAHandDrawnTree) {
    const Bvh tree{
        {Node::inner(unit, NodeId{1}),
         Node::inner(unit, NodeId{3}),
         Node::leaf(unit, 4, 3),
         Node::leaf(unit, 0, 1),
         Node::leaf(unit, 1, 3)},
        {PrimId{0}, PrimId{1}, PrimId{2}, PrimId{3}, PrimId{4}, PrimId{5}, PrimId{0}}
    };
    const TreeStatistics shape = measure_tree(tree);
    EXPECT_EQ(shape.nodes, 5U);
    EXPECT_EQ(shape.leaves, 3U);
    EXPECT_EQ(shape.references, 7U);
    EXPECT_EQ(shape.max_depth, 2);
    EXPECT_DOUBLE_EQ(shape.mean_leaf_depth, 5.0 / 3.0);
    EXPECT_EQ(shape.largest_leaf, 3U);
    EXPECT_EQ(shape.leaf_sizes, (std::map<std::size_t, std::size_t>{{1, 1}, {3, 2}}));
    EXPECT_EQ(shape.bytes, 5 * 32 + 7 * 4U);
}

} // namespace
} // namespace raywise
