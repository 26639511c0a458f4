#include <raywise/optimize/node_masses.hpp>

#include "support/median_split.hpp"
#include "support/soup.hpp"
#include "unit/build/box_sets.hpp"

#include <raywise/core/executor.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace raywise {
namespace {

TEST(NodeMasses, EmptyTreeHasNone) {
    EXPECT_TRUE(node_masses(Bvh{}, SurfaceMeasure{}).empty());
}

TEST(NodeMasses, AreTheMeasuresOfTheBoxesNarrowedOrNot) {
    test_support::Soup soup;
    for (const Aabb& box : testing::soup(500, 0.1F))
        soup.add({box.lo, box.hi, {box.lo.x, box.hi.y, box.lo.z}});
    const Bvh tree = test_support::median_split(soup.view());
    const testing::PointMeasure points = testing::random_points(200);
    for (const int threads : {1, 2}) {
        const Executor executor(threads);
        const std::vector<float> surface = node_masses(tree, SurfaceMeasure{}, executor);
        const std::vector<float> counted = node_masses(tree, points, executor);
        ASSERT_EQ(counted.size(), tree.nodes.size());
        for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
            EXPECT_EQ(surface[i], half_area(tree.nodes[i].box()));
            EXPECT_EQ(counted[i], points(tree.nodes[i].box()));
        }
    }
}

} // namespace
} // namespace raywise
