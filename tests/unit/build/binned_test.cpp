#include <raywise/build/binned.hpp>

#include <raywise/build/sweep.hpp>
#include <raywise/bvh/statistics.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/rng.hpp>

#include <gtest/gtest.h>

namespace raywise {
namespace {

TEST(BuildBinned, TreeOverNoBoxesIsEmpty) {
    EXPECT_TRUE(build_binned({}, SurfaceMeasure{}).is_empty());
}

std::vector<Aabb> soup(std::size_t count) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(7, i);
        const Vec3 v{rng.uniform(), rng.uniform(), rng.uniform()};
        boxes.push_back({v, v + Vec3{rng.uniform(), rng.uniform(), rng.uniform()} * 0.1F});
    }
    return boxes;
}

TEST(BuildBinned, RandomSoupGivesAValidTree) {
    const std::vector<Aabb> boxes = soup(20000);
    const Bvh tree = build_binned(boxes, SurfaceMeasure{});
    EXPECT_EQ(find_fault(tree, boxes), std::nullopt);
    const Bvh other = build_sweep(boxes, SurfaceMeasure{});
    EXPECT_EQ(find_fault(other, boxes), std::nullopt);
    const Bvh two = build_binned(boxes, SurfaceMeasure{}, {}, Executor(2));
    EXPECT_EQ(find_fault(two, boxes), std::nullopt);
}

} // namespace
} // namespace raywise
