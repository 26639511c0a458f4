#include <raywise/optimize/reinsertion.hpp>

#include "support/median_split.hpp"
#include "support/soup.hpp"
#include "unit/build/box_sets.hpp"

#include <raywise/bvh/refit.hpp>
#include <raywise/bvh/statistics.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/hash.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace raywise {
namespace {

using namespace testing;
using test_support::Soup;

/// A triangle across each box.
Soup triangles_in(const std::vector<Aabb>& boxes) {
    Soup soup;
    for (const Aabb& box : boxes)
        soup.add({box.lo, box.hi, {box.lo.x, box.hi.y, box.lo.z}});
    return soup;
}

Bvh halved(const std::vector<Aabb>& boxes) {
    return test_support::median_split(triangles_in(boxes).view(), 2);
}

std::vector<PrimId> sorted(std::vector<PrimId> prims) {
    std::sort(prims.begin(), prims.end());
    return prims;
}

template <HitMeasure M>
void expect_no_dearer_everywhere(const M& measure) {
    for (const BoxSet& set : pathological_sets()) {
        SCOPED_TRACE(set.name);
        const Bvh before = halved(set.boxes);
        const Bvh after = reinsert(before, measure, {.batch = 1, .least_gain = 0});
        ASSERT_EQ(find_fault(after, set.boxes), std::nullopt);
        EXPECT_EQ(sorted(after.prims), sorted(before.prims));
        EXPECT_EQ(after.nodes.size(), before.nodes.size());
        const auto cost = [&](const Bvh& tree) {
            double sum = 0;
            for (const Node& node : tree.nodes)
                if (!node.is_leaf()) sum += static_cast<double>(measure(node.box()));
            return sum;
        };
        EXPECT_LE(cost(after), cost(before) * (1 + 1e-9));
    }
}

TEST(Reinsert, SmallTreesStayAsTheyAre) {
    EXPECT_TRUE(reinsert(Bvh{}, SurfaceMeasure{}).is_empty());
    for (const std::size_t count : {1U, 2U, 4U}) {
        const Bvh tree = halved(soup(count, 0.1F));
        EXPECT_TRUE(same_bytes(reinsert(tree, SurfaceMeasure{}), tree));
    }
}

TEST(Reinsert, PathologicalTreesGetNoDearerForSurfaceArea) {
    expect_no_dearer_everywhere(SurfaceMeasure{});
}

TEST(Reinsert, PathologicalTreesGetNoDearerForABlindMeasure) {
    expect_no_dearer_everywhere(BlindMeasure{});
}

TEST(Reinsert, PathologicalTreesGetNoDearerForAWindow) {
    expect_no_dearer_everywhere(WindowMeasure{});
}

TEST(Reinsert, PathologicalTreesGetNoDearerForANarrowedMeasure) {
    expect_no_dearer_everywhere(random_points(50));
}

TEST(Reinsert, MisplacedBoxGoesHome) {
    // Two clusters, and one box of the second in the first.
    std::vector<Aabb> boxes;
    for (int i = 0; i < 8; ++i)
        boxes.push_back(cube({static_cast<float>(i % 4) + (i < 4 ? 0.F : 100.F), 0, 0}, 0.25F));
    Bvh tree;
    const std::vector<std::size_t> order{0, 1, 2, 4, 3, 5, 6, 7};
    for (const std::size_t i : order)
        tree.prims.push_back(to_prim(i));
    tree.nodes.resize(15);
    const auto leaf_box = [&](std::size_t slot) { return boxes[order[slot]]; };
    for (std::size_t i = 0; i < 8; ++i)
        tree.nodes[7 + i] = Node::leaf(leaf_box(i), static_cast<std::uint32_t>(i), 1);
    for (std::size_t i = 7; i-- > 0;)
        tree.nodes[i] = Node::inner(
            unite(tree.nodes[2 * i + 1].box(), tree.nodes[2 * i + 2].box()), to_node(2 * i + 1)
        );
    ASSERT_EQ(find_fault(tree, boxes), std::nullopt);
    const Bvh after = reinsert(tree, SurfaceMeasure{}, {.batch = 1, .least_gain = 0});
    ASSERT_EQ(find_fault(after, boxes), std::nullopt);
    for (const NodeId child : {after.root().left(), after.root().right()})
        EXPECT_LT(after[child].box().size().x, 4);
}

TEST(Reinsert, PutsAScatteredTreeInOrder) {
    const std::vector<Aabb> boxes = soup(4000, 0.05F);
    Bvh before = halved(boxes);
    const double good = tree_cost(before, SurfaceMeasure{});
    // Every second leaf's primitives change places with those far away.
    std::reverse(before.prims.begin(), before.prims.end());
    for (std::size_t i = 0; i < before.prims.size() / 2; i += 4)
        std::swap(before.prims[i], before.prims[i + before.prims.size() / 2]);
    refit(before, boxes);
    ASSERT_GT(tree_cost(before, SurfaceMeasure{}), 3 * good);
    const Bvh after =
        reinsert(before, SurfaceMeasure{}, {.batch = 1, .least_gain = 0, .max_rounds = 100});
    EXPECT_LT(tree_cost(after, SurfaceMeasure{}), 0.7 * tree_cost(before, SurfaceMeasure{}));
}

TEST(Reinsert, DepthStaysInBoundsWhereChainsAreCheapest) {
    // Concentric boxes cost least as a chain, which would be 300 levels deep.
    const std::vector<Aabb> boxes =
        series(300, [](float i) { return cube({0, 0, 0}, std::exp2(i / 8)); });
    const Bvh after =
        reinsert(halved(boxes), SurfaceMeasure{}, {.batch = 1, .least_gain = 0, .max_rounds = 200});
    ASSERT_EQ(find_fault(after, boxes), std::nullopt);
    EXPECT_GT(measure_tree(after).max_depth, 20);
}

TEST(Reinsert, PrimitivesInSeveralLeavesStay) {
    Bvh tree = halved(soup(500, 0.05F));
    for (PrimId& prim : tree.prims)
        prim = to_prim(to_index(prim) / 3);
    const Bvh after = reinsert(tree, SurfaceMeasure{}, {.batch = 1});
    ASSERT_EQ(find_fault(after, 500), std::nullopt);
    EXPECT_EQ(sorted(after.prims), sorted(tree.prims));
}

TEST(Reinsert, SameBytesForAnyNumberOfThreads) {
    std::vector<BoxSet> sets = pathological_sets();
    sets.push_back({"large soup", soup(20'000, 0.02F)});
    for (const BoxSet& set : sets) {
        SCOPED_TRACE(set.name);
        const Bvh tree = halved(set.boxes);
        const Bvh serial = reinsert(tree, SurfaceMeasure{});
        for (const int threads : {2, 3})
            EXPECT_TRUE(same_bytes(serial, reinsert(tree, SurfaceMeasure{}, {}, Executor(threads)))
            );
    }
}

TEST(Reinsert, SameBytesForEveryCompiler) {
    std::uint64_t hash = 0;
    for (const BoxSet& set : pathological_sets()) {
        const Bvh tree = reinsert(halved(set.boxes), SurfaceMeasure{}, {.batch = 1});
        hash = hash_elements(std::span<const Node>(tree.nodes), hash);
        hash = hash_elements(std::span<const PrimId>(tree.prims), hash);
    }
    // Changes with the method, and then for all compilers alike.
    EXPECT_EQ(hex(hash), "2cc7a96e37d1cf03");
}

TEST(Reinsert, RefusesParametersOutOfRange) {
    const Bvh tree = halved(soup(10, 0.1F));
    const auto run = [&](const ReinsertionParams& params) {
        static_cast<void>(reinsert(tree, SurfaceMeasure{}, params));
    };
    EXPECT_THROW(run({.batch = 0}), Error);
    EXPECT_THROW(run({.batch = 1.1}), Error);
    EXPECT_THROW(run({.least_gain = -1}), Error);
    EXPECT_THROW(run({.max_rounds = -1}), Error);
    EXPECT_THROW(run({.max_rounds = 1001}), Error);
}

} // namespace
} // namespace raywise
