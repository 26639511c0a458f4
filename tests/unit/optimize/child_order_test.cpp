#include <raywise/optimize/child_order.hpp>

#include "support/median_split.hpp"
#include "support/soup.hpp"

#include <raywise/bvh/validate.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace raywise {
namespace {

using test_support::Coordinates;
using test_support::Soup;

std::vector<Aabb> boxes_of(const Soup& soup) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < soup.corners.size(); ++i)
        boxes.push_back(bounds(soup.view()[to_prim(i)]));
    return boxes;
}

std::vector<PrimId> sorted(std::vector<PrimId> prims) {
    std::sort(prims.begin(), prims.end());
    return prims;
}

TEST(BoxCoverage, IsTheAreaSeenByUniformLines) {
    EXPECT_DOUBLE_EQ(box_coverage({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), 0.5);
    EXPECT_EQ(box_coverage({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}), 0.0);
    EXPECT_EQ(box_coverage({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}), 0.0);
}

TEST(OrderForAnyHit, EmptyTreeStaysEmpty) {
    EXPECT_TRUE(order_for_any_hit({}, {}, SurfaceMeasure{}).is_empty());
    EXPECT_TRUE(order_front_to_back({}, {0, 0, 1}).is_empty());
}

TEST(OrderForAnyHit, WallGoesBeforeDust) {
    Soup soup;
    soup.add({{0, 0, 0}, {0.01F, 0, 0}, {0, 0.01F, 0}}); // dust
    soup.add({{0, 0, 5}, {9, 0, 5}, {0, 9, 5}});         // a wall
    Bvh tree;
    tree.nodes = {
        Node::inner({{0, 0, 0}, {9, 9, 5}}, NodeId{1}),
        Node::leaf({{0, 0, 0}, {2, 2, 2}}, 0, 1),
        Node::leaf(bounds(soup.view()[PrimId{1}]), 1, 1),
    };
    tree.prims = {PrimId{0}, PrimId{1}};
    const Bvh ordered = order_for_any_hit(tree, soup.view(), SurfaceMeasure{});
    EXPECT_EQ(ordered.prims, (std::vector<PrimId>{PrimId{1}, PrimId{0}}));
    const auto before = any_hit_outlook(tree, soup.view(), SurfaceMeasure{});
    const auto after = any_hit_outlook(ordered, soup.view(), SurfaceMeasure{});
    EXPECT_LT(after[0].cost, before[0].cost);
    EXPECT_NEAR(after[0].opacity, before[0].opacity, 1e-12);
}

TEST(OrderForAnyHit, NeverCostsMoreAndKeepsEveryPrimitive) {
    for (const Coordinates how : {Coordinates::smooth, Coordinates::grid, Coordinates::mixed}) {
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            Rng rng(seed);
            const Soup soup = test_support::random_soup(rng, 200, how);
            const std::vector<Aabb> boxes = boxes_of(soup);
            const Bvh tree = test_support::median_split(soup.view(), 2);
            const Bvh ordered = order_for_any_hit(tree, soup.view(), SurfaceMeasure{});
            ASSERT_EQ(find_fault(ordered, boxes), std::nullopt);
            EXPECT_EQ(sorted(ordered.prims), sorted(tree.prims));
            const double before = any_hit_outlook(tree, soup.view(), SurfaceMeasure{})[0].cost;
            const double after = any_hit_outlook(ordered, soup.view(), SurfaceMeasure{})[0].cost;
            EXPECT_LE(after, before * (1 + 1e-12));
        }
    }
}

TEST(OrderFrontToBack, LeftIsNeverFartherThanRight) {
    Rng rng(3);
    const Soup soup = test_support::random_soup(rng, 400, Coordinates::smooth);
    const std::vector<Aabb> boxes = boxes_of(soup);
    const Vec3d direction{0.3, -0.8, 0.5};
    const Bvh tree = order_front_to_back(test_support::median_split(soup.view(), 2), direction);
    ASSERT_EQ(find_fault(tree, boxes), std::nullopt);
    for (const Node& node : tree.nodes) {
        if (node.is_leaf()) continue;
        const auto depth = [&](const Aabb& box) {
            return dot(to_double(box.lo) + to_double(box.hi), direction);
        };
        EXPECT_LE(depth(tree[node.left()].box()), depth(tree[node.right()].box()));
    }
}

} // namespace
} // namespace raywise
