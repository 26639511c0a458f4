#include <raywise/build/binned.hpp>

#include "unit/build/box_sets.hpp"

#include <raywise/build/sweep.hpp>
#include <raywise/bvh/statistics.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/hash.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace raywise {
namespace {

using namespace testing;

template <HitMeasure M>
void expect_valid_everywhere(const M& measure) {
    for (const BoxSet& set : pathological_sets()) {
        SCOPED_TRACE(set.name);
        const Bvh tree = build_binned(set.boxes, measure);
        ASSERT_EQ(find_fault(tree, set.boxes), std::nullopt);
        EXPECT_EQ(tree.prims.size(), set.boxes.size());
        EXPECT_LE(measure_tree(tree).largest_leaf, BinnedParams{}.max_leaf_size);
    }
}

TEST(BuildBinned, TreeOverNoBoxesIsEmpty) {
    const Bvh tree = build_binned({}, SurfaceMeasure{});
    EXPECT_TRUE(tree.is_empty());
    EXPECT_TRUE(tree.prims.empty());
}

TEST(BuildBinned, OneBoxIsALeaf) {
    const std::vector<Aabb> boxes{cube({1, 2, 3}, 1)};
    const Bvh tree = build_binned(boxes, SurfaceMeasure{});
    ASSERT_EQ(tree.nodes.size(), 1U);
    EXPECT_TRUE(tree.root().is_leaf());
    EXPECT_EQ(tree.root().box(), boxes[0]);
    EXPECT_EQ(tree.prims, std::vector{PrimId{0}});
}

TEST(BuildBinned, PathologicalBoxesGiveValidTreesForSurfaceArea) {
    expect_valid_everywhere(SurfaceMeasure{});
}

TEST(BuildBinned, PathologicalBoxesGiveValidTreesForABlindMeasure) {
    expect_valid_everywhere(BlindMeasure{});
}

TEST(BuildBinned, PathologicalBoxesGiveValidTreesForAConstantMeasure) {
    expect_valid_everywhere(ConstantMeasure{});
}

TEST(BuildBinned, PathologicalBoxesGiveValidTreesForAWindow) {
    expect_valid_everywhere(WindowMeasure{});
}

TEST(BuildBinned, PathologicalBoxesGiveValidTreesForANarrowedMeasure) {
    expect_valid_everywhere(random_points(50));
}

TEST(BuildBinned, IdenticalBoxesAreHalvedInTheirOrder) {
    const std::vector<Aabb> boxes(64, cube({0, 0, 0}, 1));
    const Bvh tree = build_binned(boxes, SurfaceMeasure{});
    const TreeStatistics shape = measure_tree(tree);
    EXPECT_EQ(shape.leaves, 8U);
    EXPECT_EQ(shape.max_depth, 3);
    for (std::size_t i = 0; i < boxes.size(); ++i)
        EXPECT_EQ(tree.prims[i], to_prim(i));
}

TEST(BuildBinned, RefusesBoxesThatNoTreeCanHold) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (const Aabb& bad :
         {Aabb{},
          Aabb{{nan, 0, 0}, {1, 1, 1}},
          Aabb{{0, 0, 0}, {1, nan, 1}},
          Aabb{{0, 0, 0}, {1, 1, infinity}},
          Aabb{{-infinity, 0, 0}, {1, 1, 1}},
          Aabb{{0, 0, 0}, {0x1.1p60F, 1, 1}},
          Aabb{{2, 0, 0}, {1, 1, 1}}}) {
        std::vector<Aabb> boxes(100'000, cube({0, 0, 0}, 1));
        boxes[70'000] = bad;
        boxes[90'000] = bad;
        for (const int threads : {1, 2}) {
            try {
                static_cast<void>(build_binned(boxes, SurfaceMeasure{}, {}, Executor(threads)));
                ADD_FAILURE() << "no error";
            } catch (const Error& error) {
                EXPECT_STREQ(error.what(), "box 70000 is empty, not finite or beyond +-2^60");
            }
        }
    }
}

TEST(BuildBinned, RefusesParametersOutOfRange) {
    const std::vector<Aabb> boxes = soup(10, 0.1F);
    const auto build = [&](const BinnedParams& params) {
        static_cast<void>(build_binned(boxes, SurfaceMeasure{}, params));
    };
    EXPECT_THROW(build({.bin_count = 1}), Error);
    EXPECT_THROW(build({.bin_count = 257}), Error);
    EXPECT_THROW(build({.max_leaf_size = 0}), Error);
    EXPECT_THROW(build({.max_depth = 0}), Error);
    EXPECT_THROW(build({.max_depth = 65}), Error);
    EXPECT_THROW(build({.cost = {.node = 0, .prim = 1}}), Error);
    EXPECT_THROW(build({.cost = {.node = 1, .prim = -1}}), Error);
    EXPECT_NO_THROW(build({.bin_count = 256, .max_leaf_size = 1, .max_depth = 64}));
}

TEST(BuildBinned, DepthStaysInBoundsAndLeavesSmallWhereHalvingSuffices) {
    for (const BoxSet& set : pathological_sets()) {
        SCOPED_TRACE(set.name);
        for (const int depth : {1, 3, 9, 12}) {
            const BinnedParams params{.max_leaf_size = 2, .max_depth = depth};
            const Bvh tree = build_binned(set.boxes, SurfaceMeasure{}, params);
            ASSERT_EQ(find_fault(tree, set.boxes), std::nullopt);
            const TreeStatistics shape = measure_tree(tree);
            EXPECT_LE(shape.max_depth, depth);
            const auto room = std::size_t{2} << static_cast<unsigned>(depth);
            EXPECT_TRUE(set.boxes.size() > room || shape.largest_leaf <= 2);
        }
    }
}

TEST(BuildBinned, SameBytesForAnyNumberOfThreads) {
    std::vector<BoxSet> sets = pathological_sets();
    sets.push_back({"large soup", soup(150'000, 0.01F)});
    for (const BoxSet& set : sets) {
        SCOPED_TRACE(set.name);
        const Bvh serial = build_binned(set.boxes, SurfaceMeasure{});
        for (const int threads : {2, 3, 8})
            EXPECT_TRUE(
                same_bytes(serial, build_binned(set.boxes, SurfaceMeasure{}, {}, Executor(threads)))
            );
    }
}

TEST(BuildBinned, SameBytesForEveryCompiler) {
    std::uint64_t hash = 0;
    for (const BoxSet& set : pathological_sets()) {
        const Bvh tree = build_binned(set.boxes, SurfaceMeasure{});
        hash = hash_elements(std::span<const Node>(tree.nodes), hash);
        hash = hash_elements(std::span<const PrimId>(tree.prims), hash);
    }
    // Changes with the method, and then for all compilers alike.
    EXPECT_EQ(hex(hash), "b733f0fef5cc107f");
}

TEST(BuildBinned, PairsStandInDepthFirstOrder) {
    const Bvh tree = build_binned(soup(50'000, 0.01F), SurfaceMeasure{}, {}, Executor(3));
    std::size_t next = 1;
    const auto visit = [&](const auto& self, NodeId id) -> void {
        if (tree[id].is_leaf()) return;
        ASSERT_EQ(to_index(tree[id].left()), next);
        next += 2;
        self(self, tree[id].left());
        self(self, tree[id].right());
    };
    visit(visit, NodeId{0});
    EXPECT_EQ(next, tree.nodes.size());
}

TEST(BuildBinned, CostIsCloseToTheSweeps) {
    for (const float side : {0.001F, 0.05F, 0.5F}) {
        const std::vector<Aabb> boxes = soup(4000, side);
        const double binned = tree_cost(build_binned(boxes, SurfaceMeasure{}), SurfaceMeasure{});
        const double swept = tree_cost(build_sweep(boxes, SurfaceMeasure{}), SurfaceMeasure{});
        EXPECT_LT(binned, 1.03 * swept) << side;
        EXPECT_GT(binned, 0.97 * swept) << side;
    }
}

TEST(BuildBinned, TiesGoToTheBalancedSplitOnTheLowestAxis) {
    // Every split costs the same; x and y would order the boxes oppositely. Few are swept, many
    // binned.
    for (const std::size_t count : {4U, 64U}) {
        const auto boxes = series(count, [](float i) { return cube({i, -i, i}, 0.1F); });
        const Bvh tree = build_binned(boxes, ConstantMeasure{}, {.max_leaf_size = 1});
        Aabb left;
        for (std::size_t i = 0; i < count / 2; ++i)
            left = unite(left, boxes[i]);
        EXPECT_EQ(tree[tree.root().left()].box(), left) << count;
    }
}

TEST(BuildBinned, SmallLeafIsKeptWhenNoSplitIsCheaper) {
    // Both boxes nearly fill their parent: a split costs 2 + 2.4, a leaf 2.4.
    const std::vector<Aabb> boxes{cube({0, 0, 0}, 1), cube({0.01F, 0, 0}, 1)};
    EXPECT_EQ(build_binned(boxes, SurfaceMeasure{}).nodes.size(), 1U);
    EXPECT_EQ(build_binned(boxes, SurfaceMeasure{}, {.max_leaf_size = 1}).nodes.size(), 3U);
    EXPECT_EQ(
        build_binned(boxes, SurfaceMeasure{}, {.cost = {.node = 0.001, .prim = 1.2}}).nodes.size(),
        3U
    );
}

TEST(BuildBinned, BlindMeasureBuildsTheSurfaceAreaTree) {
    const std::vector<Aabb> boxes = soup(2000, 0.05F);
    EXPECT_TRUE(
        same_bytes(build_binned(boxes, BlindMeasure{}), build_binned(boxes, SurfaceMeasure{}))
    );
}

TEST(BuildBinned, NarrowingChangesNothing) {
    const std::vector<Aabb> boxes = soup(2000, 0.05F);
    const PointMeasure points = random_points(400);
    const auto plain = [&](const Aabb& box) { return points(box); };
    EXPECT_TRUE(same_bytes(build_binned(boxes, points), build_binned(boxes, plain)));
}

TEST(BuildBinned, FilteredAxesAreUsedOnlyWhenTheOthersCannotSplit) {
    struct OnlyX {
        AxisRanking operator()(const Aabb&) const { return rank_axes(1, 0, 0); }
    };
    const AxisFilter<OnlyX> only_x{.policy = {}, .threshold = 0.5F};
    // A thin slab that surface area would cut across y.
    const std::vector<Aabb> slab = series(64, [](float i) { return cube({i / 64, i, 0}, 0.01F); });
    const Bvh tree = build_binned(slab, SurfaceMeasure{}, {}, serial_executor(), only_x);
    EXPECT_EQ(find_fault(tree, slab), std::nullopt);
    // Only y can split.
    const std::vector<Aabb> column = series(64, [](float i) { return cube({0, i, 0}, 0.01F); });
    EXPECT_TRUE(same_bytes(
        build_binned(column, SurfaceMeasure{}, {}, serial_executor(), only_x),
        build_binned(column, SurfaceMeasure{})
    ));
    // x and y order these boxes differently, so the filter shows.
    const std::vector<Aabb> crossed{
        cube({0, 0, 0}, 0.1F), cube({1, 10, 0}, 0.1F), cube({0, 10, 0}, 0.1F), cube({1, 0, 0}, 0.1F)
    };
    const BinnedParams params{.max_leaf_size = 2};
    const Bvh free = build_binned(crossed, SurfaceMeasure{}, params);
    const Bvh forced = build_binned(crossed, SurfaceMeasure{}, params, serial_executor(), only_x);
    EXPECT_EQ(free[free.root().left()].box().hi.y, 0.1F);
    EXPECT_EQ(forced[forced.root().left()].box().hi.x, 0.1F);
}

} // namespace
} // namespace raywise
