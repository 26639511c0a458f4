#include <raywise/optimize/loose_tree.hpp>

#include "support/median_split.hpp"
#include "support/soup.hpp"
#include "unit/build/box_sets.hpp"

#include <raywise/bvh/validate.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/optimize/depth_first.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace raywise {
namespace {

Bvh tree_of(const LooseTree<SurfaceMeasure>& loose, const Bvh& original) {
    Bvh tree;
    tree.prims = original.prims;
    for (std::uint32_t i = 0; i < loose.size(); ++i)
        tree.nodes.push_back(loose.node(i));
    return depth_first(tree);
}

double inner_mass(const Bvh& tree) {
    double sum = 0;
    for (const Node& node : tree.nodes)
        if (!node.is_leaf()) sum += static_cast<double>(half_area(node.box()));
    return sum;
}

TEST(LooseTree, RandomMovesKeepTheTreeValidAndNeverRaiseItsMass) {
    const std::vector<Aabb> boxes = testing::soup(300, 0.2F);
    test_support::Soup soup;
    for (const Aabb& box : boxes)
        soup.add({box.lo, box.hi, {box.lo.x, box.hi.y, box.lo.z}});
    const Bvh tree = test_support::median_split(soup.view(), 1);
    const SurfaceMeasure measure;
    LooseTree<SurfaceMeasure> loose(tree, measure);
    Rng rng(1);
    int made = 0;
    for (int i = 0; i < 20'000; ++i) {
        const auto moved = static_cast<std::uint32_t>(rng.below(loose.size()));
        const auto target = static_cast<std::uint32_t>(rng.below(loose.size()));
        const double before = loose.inner_mass();
        const bool is_made = loose.move(moved, target);
        made += is_made ? 1 : 0;
        if (is_made)
            ASSERT_LT(loose.inner_mass(), before);
        else
            ASSERT_EQ(loose.inner_mass(), before);
        if (i % 1000 != 0) continue;
        const Bvh now = tree_of(loose, tree);
        ASSERT_EQ(find_fault(now, boxes), std::nullopt);
        ASSERT_EQ(now.prims.size(), boxes.size());
        ASSERT_NEAR(loose.inner_mass(), inner_mass(now), 1e-6 * inner_mass(now));
    }
    EXPECT_GT(made, 50);
}

} // namespace
} // namespace raywise
