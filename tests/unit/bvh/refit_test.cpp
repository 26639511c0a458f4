#include <raywise/bvh/refit.hpp>

#include <raywise/bvh/validate.hpp>

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace raywise {
namespace {

Aabb span_x(float lo, float hi) {
    return {{lo, 0, 0}, {hi, 1, 1}};
}

TEST(Refit, LeavesAnEmptyTreeAlone) {
    Bvh tree;
    refit(tree, {});
    EXPECT_TRUE(tree.is_empty());
}

TEST(Refit, BoxesAreTheTightestAroundMovedPrimitives) {
    Bvh tree{
        {Node::inner(span_x(0, 4), NodeId{1}),
         Node::inner(span_x(0, 4), NodeId{3}),
         Node::leaf(span_x(3, 4), 2, 1),
         Node::leaf(span_x(0, 2), 0, 1),
         Node::leaf(span_x(0, 2), 1, 1)},
        {PrimId{2}, PrimId{0}, PrimId{1}}
    };
    const std::vector<Aabb> moved{span_x(10, 11), span_x(-5, -4), span_x(20, 22)};
    refit(tree, moved);
    EXPECT_EQ(find_fault(tree, moved), std::nullopt);
    EXPECT_EQ(tree.nodes[0].box(), span_x(-5, 22));
    EXPECT_EQ(tree.nodes[1].box(), span_x(10, 22));
    EXPECT_EQ(tree.nodes[2].box(), span_x(-5, -4));
    EXPECT_EQ(tree.nodes[3].box(), span_x(20, 22));
    EXPECT_EQ(tree.nodes[4].box(), span_x(10, 11));
    EXPECT_EQ(tree.nodes[1].left(), NodeId{3});
}

} // namespace
} // namespace raywise
