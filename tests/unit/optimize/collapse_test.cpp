#include <raywise/optimize/collapse.hpp>

#include "support/median_split.hpp"
#include "support/soup.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

namespace raywise {
namespace {

using namespace test_support;

/// Walks a wide tree; checks that boxes enclose what is below and counts where triangles stand.
class Checker {
public:
    Checker(const WideBvh& tree, const TriangleView& triangles)
        : tree_(tree), triangles_(triangles) {}

    void check_node(std::size_t index, const Aabb* around) {
        ASSERT_LT(index, tree_.nodes.size());
        ++nodes;
        const WideNode& node = tree_.nodes[index];
        bool ended = false;
        for (std::size_t slot = 0; slot < WideNode::width; ++slot) {
            if (!node.is_used(slot)) {
                ended = true;
                ASSERT_TRUE(node.box(slot).is_empty());
                continue;
            }
            ASSERT_FALSE(ended) << "the slots in use come first";
            const Aabb box = node.box(slot);
            if (around != nullptr) {
                ASSERT_TRUE(contains(*around, box));
            }
            ASSERT_TRUE(contains(tree_.box, box));
            const WideRef child = node.children[slot];
            if (child.is_leaf())
                check_leaf(child.index(), box);
            else
                check_node(child.index(), &box);
        }
    }

    void check_leaf(std::size_t index, const Aabb& box) {
        std::vector<PrimId> here;
        for (;; ++index) {
            ASSERT_LT(index, tree_.blocks.size());
            ++blocks;
            const TriangleBlock& block = tree_.blocks[index];
            for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane) {
                const PrimId prim = block.prims[lane];
                if (prim == no_prim) continue;
                ASSERT_EQ(block.triangle(lane), triangles_[prim]);
                ASSERT_TRUE(overlaps(box, bounds(triangles_[prim])));
                here.push_back(prim);
                ++places[prim];
            }
            if (block.is_last != 0) break;
        }
        std::sort(here.begin(), here.end());
        ASSERT_EQ(std::unique(here.begin(), here.end()), here.end());
    }

    std::size_t nodes = 0;
    std::size_t blocks = 0;
    std::map<PrimId, int> places;

private:
    const WideBvh& tree_;
    TriangleView triangles_;
};

bool same_bytes(const WideBvh& a, const WideBvh& b) {
    return a.nodes.size() == b.nodes.size() && a.blocks.size() == b.blocks.size() &&
           (a.nodes.empty() ||
            std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(WideNode)) == 0) &&
           (a.blocks.empty() ||
            std::memcmp(
                a.blocks.data(), b.blocks.data(), a.blocks.size() * sizeof(TriangleBlock)
            ) == 0);
}

TEST(Collapse, EmptyTreeStaysEmpty) {
    EXPECT_TRUE(collapse(Bvh{}, TriangleView{}, SurfaceMeasure{}).is_empty());
}

TEST(Collapse, RefusesParametersOutOfRange) {
    EXPECT_THROW(
        static_cast<void>(collapse(Bvh{}, TriangleView{}, SurfaceMeasure{}, {.block_cost = 0})),
        Error
    );
    EXPECT_THROW(
        static_cast<void>(collapse(Bvh{}, TriangleView{}, SurfaceMeasure{}, {.max_leaf_size = 65})),
        Error
    );
}

TEST(Collapse, KeepsEveryTriangleOnceInsideItsBoxes) {
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(31, i);
        const Soup soup = random_soup(rng, 500, Coordinates::smooth);
        const Bvh binary = median_split(soup.view(), 1 + i % 5);
        const CollapseParams params{.block_cost = 0.25 * static_cast<double>(1 + i % 8)};
        const WideBvh tree = collapse(binary, soup.view(), SurfaceMeasure{}, params);
        Checker checker(tree, soup.view());
        checker.check_node(0, nullptr);
        if (HasFatalFailure()) FAIL() << i;
        EXPECT_EQ(checker.nodes, tree.nodes.size());
        EXPECT_EQ(checker.blocks, tree.blocks.size());
        EXPECT_EQ(checker.places.size(), soup.corners.size());
        for (const auto& [prim, count] : checker.places)
            EXPECT_EQ(count, 1);
        for (std::size_t k = 0; k < soup.corners.size(); ++k) {
            EXPECT_TRUE(contains(tree.vertex_bounds, bounds(soup.view()[to_prim(k)])));
        }
        EXPECT_TRUE(
            same_bytes(tree, collapse(binary, soup.view(), SurfaceMeasure{}, params, Executor(3)))
        );
    }
}

TEST(Collapse, TriangleOfSeveralLeavesStandsOnceInAMergedOne) {
    Soup soup;
    soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    soup.add({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
    Bvh binary;
    const Aabb box{{0, 0, 0}, {1, 1, 1}};
    binary.nodes = {Node::inner(box, NodeId{1}), Node::leaf(box, 0, 2), Node::leaf(box, 2, 1)};
    binary.prims = {PrimId{1}, PrimId{0}, PrimId{1}};
    const WideBvh tree = collapse(binary, soup.view(), SurfaceMeasure{}, {.block_cost = 0.1});
    ASSERT_EQ(tree.blocks.size(), 1U);
    EXPECT_EQ(tree.blocks[0].prims[0], PrimId{0});
    EXPECT_EQ(tree.blocks[0].prims[1], PrimId{1});
    EXPECT_EQ(tree.blocks[0].prims[2], no_prim);
}

/// A big box with a hair in it and a small one that is full: rays that look for any hit should try
/// the full one first, which is the last slot.
TEST(Collapse, WhatStopsMoreRaysForItsCostStandsLast) {
    Soup soup;
    soup.add({{0, 0, 0}, {10, 10, 10}, {0, 0.01F, 0}});
    for (int i = 0; i < 6; ++i) {
        const float x = 20 + static_cast<float>(i) * 0.1F;
        soup.add({{x, 0, 0}, {x, 0, 2}, {x, 2, 0}});
        soup.add({{x, 2, 2}, {x, 2, 0}, {x, 0, 2}});
    }
    const Bvh binary = median_split(soup.view(), 1);
    const WideBvh tree = collapse(binary, soup.view(), SurfaceMeasure{}, {.max_leaf_size = 1});
    const WideNode& root = tree.nodes[0];
    std::size_t hair = WideNode::width;
    std::size_t used = 0;
    for (; used < WideNode::width && root.is_used(used); ++used)
        if (root.box(used).lo.x == 0) hair = used;
    ASSERT_GT(used, 1U);
    EXPECT_EQ(hair, 0U);
}

/// What collapse minimizes.
double cost_of(const WideBvh& tree, double block_cost) {
    auto cost = static_cast<double>(half_area(tree.box));
    for (const WideNode& node : tree.nodes)
        for (std::size_t slot = 0; slot < WideNode::width && node.is_used(slot); ++slot) {
            const auto weight = static_cast<double>(half_area(node.box(slot)));
            const WideRef child = node.children[slot];
            if (!child.is_leaf()) {
                cost += weight;
                continue;
            }
            for (std::size_t i = child.index();; ++i) {
                cost += weight * block_cost;
                if (tree.blocks[i].is_last != 0) break;
            }
        }
    return cost;
}

TEST(Collapse, CostsLessThanCuttingAtEveryThirdLevel) {
    Rng rng(33);
    const Soup soup = random_soup(rng, 2000, Coordinates::smooth);
    const Bvh binary = median_split(soup.view(), 2);
    const double best = cost_of(collapse(binary, soup.view(), SurfaceMeasure{}), 0.5);
    // Full nodes everywhere, as few of them as possible, but chosen without looking at areas.
    double third_level = 0;
    const auto add = [&](const auto& self, NodeId id, int level) -> void {
        const Node& node = binary[id];
        const auto weight = static_cast<double>(half_area(node.box()));
        if (node.is_leaf()) {
            third_level += 0.5 * weight;
            return;
        }
        if (level % 3 == 0) third_level += weight;
        self(self, node.left(), level + 1);
        self(self, node.right(), level + 1);
    };
    add(add, NodeId{0}, 0);
    EXPECT_LT(best, third_level);
}

} // namespace
} // namespace raywise
