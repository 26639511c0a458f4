#include <raywise/bvh/remap.hpp>

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace raywise {
namespace {

TEST(RemapPrims, RenamesEverySlot) {
    Bvh tree{{}, {PrimId{1}, PrimId{0}, PrimId{1}}};
    remap_prims(tree, std::vector{PrimId{70}, PrimId{80}});
    EXPECT_EQ(tree.prims, (std::vector{PrimId{80}, PrimId{70}, PrimId{80}}));
}

TEST(RemapPrims, RefusesAPrimitiveWithoutANameAndChangesNothing) {
    Bvh tree{{}, {PrimId{0}, PrimId{1}}};
    EXPECT_THROW(remap_prims(tree, std::vector{PrimId{70}}), Error);
    EXPECT_EQ(tree.prims, (std::vector{PrimId{0}, PrimId{1}}));
}

TEST(RemapPrims, RenamesTheLanesInUseOfAWideTree) {
    WideBvh tree;
    tree.blocks.resize(1);
    for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane)
        tree.blocks[0].clear(lane);
    tree.blocks[0].set(0, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, PrimId{1});
    EXPECT_THROW(remap_prims(tree, std::vector{PrimId{70}}), Error);
    EXPECT_EQ(tree.blocks[0].prims[0], PrimId{1});
    remap_prims(tree, std::vector{PrimId{70}, PrimId{80}});
    EXPECT_EQ(tree.blocks[0].prims[0], PrimId{80});
    EXPECT_EQ(tree.blocks[0].prims[1], no_prim);
}

} // namespace
} // namespace raywise
