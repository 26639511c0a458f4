#include <raywise/trace/count_unpruned.hpp>

#include "support/median_split.hpp"
#include "support/soup.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/ray_box.hpp>
#include <raywise/trace/observer.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>

namespace raywise {
namespace {

using namespace test_support;

TEST(CountUnpruned, NothingIsCountedWithoutATreeOrAValidRay) {
    EXPECT_EQ(count_unpruned(Bvh{}, {{0, 0, 0}, {1, 0, 0}}), Counts{});
    Soup soup;
    soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_EQ(count_unpruned(median_split(soup.view()), {{0, 0, 0}, {0, 0, 0}}), Counts{});
}

TEST(CountUnpruned, RayThatMissesTheRootCostsNothing) {
    Soup soup;
    soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const Counts counts = count_unpruned(median_split(soup.view()), {{5, 5, 5}, {1, 0, 0}});
    EXPECT_EQ(counts, (Counts{1, 0, 0, 0}));
    EXPECT_EQ(cost_of(counts), 0);
}

TEST(CountUnpruned, OpensEverythingBehindAHit) {
    Soup soup;
    for (int i = 0; i < 4; ++i) {
        const auto z = static_cast<float>(i);
        soup.add({{0, 0, z}, {1, 0, z}, {0, 1, z}});
    }
    const Bvh tree = median_split(soup.view(), 1);
    // t_min and t_max do not matter.
    const Counts counts = count_unpruned(tree, {{0.25F, 0.25F, 9}, {0, 0, -1}, 1, 2});
    EXPECT_EQ(counts, (Counts{7, 3, 4, 4}));
    EXPECT_DOUBLE_EQ(cost_of(counts), 2 * 3 + 1.2 * 4);
    EXPECT_DOUBLE_EQ(cost_of(counts, {.node = 0.5, .prim = 2}), 3 + 2 * 4);
}

TEST(CountUnpruned, CountsTheBoxesThatTheReferenceTestHits) {
    std::uint64_t opened = 0;
    for (std::uint64_t i = 0; i < 300; ++i) {
        Rng rng(15, i);
        const Soup soup = random_soup(rng, 64, Coordinates::smooth);
        const Bvh tree = median_split(soup.view());
        const Ray ray{point(rng, Coordinates::smooth), point(rng, Coordinates::smooth)};
        Counts expected{1, 0, 0, 0};
        for (const Node& node : tree.nodes) {
            if (!intersect(ray, node.box())) continue;
            if (node.is_leaf()) {
                ++expected.leaves;
                expected.prims += node.count();
            } else {
                ++expected.inners;
                expected.boxes += 2;
            }
        }
        ASSERT_EQ(count_unpruned(tree, ray), expected) << i;
        opened += expected.node_visits();
    }
    EXPECT_GT(opened, 1000U);
}

} // namespace
} // namespace raywise
