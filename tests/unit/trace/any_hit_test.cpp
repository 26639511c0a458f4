#include <raywise/trace/any_hit.hpp>

#include "support/median_split.hpp"
#include "support/soup.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/trace/brute_force.hpp>
#include <raywise/trace/observer.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise {
namespace {

using namespace test_support;

TEST(AnyHit, EmptyTreeOccludesNothing) {
    Counts counts;
    EXPECT_FALSE(any_hit(Bvh{}, PackedTriangles{}, {{0, 0, 0}, {1, 0, 0}}, counts));
    EXPECT_EQ(counts, Counts{});
}

TEST(AnyHit, StopsAtTheFirstTriangleFound) {
    Soup soup;
    for (int i = 0; i < 8; ++i)
        soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const Bvh tree = median_split(soup.view(), 8);
    Counts counts;
    EXPECT_TRUE(
        any_hit(tree, IndexedTriangles(soup.view()), {{0.25F, 0.25F, 1}, {0, 0, -1}}, counts)
    );
    EXPECT_EQ(counts, (Counts{1, 0, 1, 1}));
}

TEST(AnyHit, AgreesWithBruteForceOnSoups) {
    std::array<int, 2> seen{};
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng rng(12, i);
        const auto how = static_cast<Coordinates>(rng.below(4));
        const Soup soup = random_soup(rng, 64, how);
        const Bvh tree = median_split(soup.view(), 1 + i % 4);
        for (int k = 0; k < 20; ++k) {
            const Ray ray = random_ray(rng, soup, how);
            const bool expected = brute_force_any_hit(soup.view(), ray);
            ASSERT_EQ(any_hit(tree, IndexedTriangles(soup.view()), ray), expected) << i << ' ' << k;
            ++seen[expected ? 1 : 0];
        }
    }
    EXPECT_GT(seen[0], 1000);
    EXPECT_GT(seen[1], 1000);
}

TEST(AnyHit, BatchAnswersEveryRay) {
    Rng rng(5);
    const Soup soup = random_soup(rng, 64, Coordinates::smooth);
    const Bvh tree = median_split(soup.view());
    const PackedTriangles triangles(tree, soup.view());
    std::vector<Ray> rays;
    for (int i = 0; i < 3000; ++i)
        rays.push_back(random_ray(rng, soup, Coordinates::smooth));
    const auto occluded = std::make_unique<bool[]>(rays.size());
    any_hits(tree, triangles, rays, {occluded.get(), rays.size()}, Executor(2));
    for (std::size_t i = 0; i < rays.size(); ++i)
        ASSERT_EQ(occluded[i], any_hit(tree, triangles, rays[i]));
    EXPECT_THROW(any_hits(tree, triangles, rays, {}), Error);
}

} // namespace
} // namespace raywise
