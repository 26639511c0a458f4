#include <raywise/build/sweep.hpp>

#include "unit/build/box_sets.hpp"

#include <raywise/bvh/statistics.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/executor.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

namespace raywise {
namespace {

using namespace testing;

/// The least m(L) n_L + m(R) n_R over every axis and every bound between centroids, straight from
/// the definition.
double least_split_sum(const std::vector<Aabb>& boxes) {
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis)
        for (const Aabb& pivot : boxes) {
            Aabb left;
            Aabb right;
            double left_count = 0;
            double right_count = 0;
            for (const Aabb& box : boxes) {
                const bool goes_left =
                    box.lo[axis] + box.hi[axis] < pivot.lo[axis] + pivot.hi[axis];
                (goes_left ? left : right) = unite(goes_left ? left : right, box);
                ++(goes_left ? left_count : right_count);
            }
            if (left_count == 0) continue;
            least = std::min(
                least,
                static_cast<double>(half_area(left)) * left_count +
                    static_cast<double>(half_area(right)) * right_count
            );
        }
    return least;
}

TEST(BuildSweep, TreeOverNoBoxesIsEmpty) {
    EXPECT_TRUE(build_sweep({}, SurfaceMeasure{}).is_empty());
}

TEST(BuildSweep, PathologicalBoxesGiveValidTrees) {
    for (const BoxSet& set : pathological_sets()) {
        SCOPED_TRACE(set.name);
        for (const Bvh& tree :
             {build_sweep(set.boxes, SurfaceMeasure{}),
              build_sweep(set.boxes, BlindMeasure{}),
              build_sweep(set.boxes, WindowMeasure{}),
              build_sweep(set.boxes, ConstantMeasure{})}) {
            ASSERT_EQ(find_fault(tree, set.boxes), std::nullopt);
            EXPECT_LE(measure_tree(tree).largest_leaf, BinnedParams{}.max_leaf_size);
        }
    }
}

TEST(BuildSweep, RootSplitOfFewBoxesIsTheBestOfAll) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const std::size_t count = 2 + seed % 9;
        const std::vector<Aabb> boxes = soup(count, 0.3F, seed);
        const Bvh tree = build_sweep(boxes, SurfaceMeasure{}, {.max_leaf_size = 1});
        std::size_t left_count = 0;
        const auto count_leaves = [&](const auto& self, NodeId id) -> std::size_t {
            if (tree[id].is_leaf()) return tree[id].count();
            return self(self, tree[id].left()) + self(self, tree[id].right());
        };
        left_count = count_leaves(count_leaves, tree.root().left());
        const double sum = static_cast<double>(half_area(tree[tree.root().left()].box())) *
                               static_cast<double>(left_count) +
                           static_cast<double>(half_area(tree[tree.root().right()].box())) *
                               static_cast<double>(count - left_count);
        EXPECT_EQ(sum, least_split_sum(boxes)) << seed;
    }
}

TEST(BuildSweep, SameBytesForAnyNumberOfThreads) {
    const std::vector<Aabb> boxes = soup(40'000, 0.01F);
    const Bvh serial = build_sweep(boxes, SurfaceMeasure{});
    for (const int threads : {2, 3, 8})
        EXPECT_TRUE(same_bytes(serial, build_sweep(boxes, SurfaceMeasure{}, {}, Executor(threads)))
        );
}

} // namespace
} // namespace raywise
