#include <raywise/trace/closest_hit.hpp>

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
#include <limits>
#include <optional>
#include <vector>

namespace raywise {
namespace {

using namespace test_support;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr Ray down{{0.25F, 0.25F, 5}, {0, 0, -1}};

/// `count` parallel unit triangles at heights 0, 1, 2, ...
Soup stack_of(int count) {
    Soup soup;
    for (int i = 0; i < count; ++i) {
        const auto z = static_cast<float>(i);
        soup.add({{0, 0, z}, {1, 0, z}, {0, 1, z}});
    }
    return soup;
}

TEST(ClosestHit, EmptyTreeIsNeverHitAndNothingIsTested) {
    Counts counts;
    EXPECT_EQ(closest_hit(Bvh{}, PackedTriangles{}, down, counts), std::nullopt);
    EXPECT_EQ(counts, Counts{});
}

TEST(ClosestHit, InvalidRaysVisitNothing) {
    const Soup soup = stack_of(3);
    const Bvh tree = median_split(soup.view());
    const IndexedTriangles triangles(soup.view());
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (const Ray& ray :
         {Ray{{nan, 0, 0}, {0, 0, 1}},
          Ray{{0, 0, 0}, {0, 0, nan}},
          Ray{{0, 0, 0}, {0, -0.0F, 0}},
          Ray{{infinity, 0, 0}, {0, 0, 1}},
          Ray{{0, 0, 0}, {0, 0, infinity}},
          Ray{{0, 0, 0}, {0, 0, 1}, 2, 1},
          Ray{{0, 0, 0}, {0, 0, 1}, nan, 1},
          Ray{{0, 0, 0}, {0, 0, 1}, 0, nan},
          Ray{{0, 0, 0}, {0, 0, 1}, -1, 1}}) {
        Counts counts;
        EXPECT_EQ(closest_hit(tree, triangles, ray, counts), std::nullopt);
        EXPECT_EQ(counts, Counts{});
    }
}

TEST(ClosestHit, NearerChildrenComeFirstAndHideTheRest) {
    const Soup soup = stack_of(4);
    const Bvh tree = median_split(soup.view(), 1);
    Counts counts;
    const auto hit = closest_hit(tree, IndexedTriangles(soup.view()), down, counts);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->t, 2);
    EXPECT_EQ(hit->prim, PrimId{3});
    // Root and upper half opened, the nearest leaf hit, everything else pruned.
    EXPECT_EQ(counts, (Counts{5, 2, 1, 1}));
}

TEST(ClosestHit, EqualDistancesGoToTheLowestId) {
    Soup soup;
    for (int i = 0; i < 9; ++i)
        soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    for (std::size_t leaf_size = 1; leaf_size < 10; ++leaf_size) {
        Bvh tree = median_split(soup.view(), leaf_size);
        std::reverse(tree.prims.begin(), tree.prims.end());
        const auto hit = closest_hit(tree, PackedTriangles(tree, soup.view()), down);
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->prim, PrimId{0});
    }
}

TEST(ClosestHit, ExcludedTriangleGivesWayToTheNext) {
    const Soup soup = stack_of(3);
    const Bvh tree = median_split(soup.view(), 1);
    Ray ray = down;
    ray.excluded = PrimId{2};
    const auto hit = closest_hit(tree, IndexedTriangles(soup.view()), ray);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->prim, PrimId{1});
}

/// The depth limit reached: a comb of `Bvh::max_depth` levels with a triangle at each.
TEST(ClosestHit, TreeOfTheGreatestDepthFitsTheStack) {
    constexpr int depth = Bvh::max_depth;
    const Soup soup = stack_of(depth + 1);
    Bvh tree;
    tree.nodes.resize(1);
    std::size_t at = 0;
    const auto box_from = [&](int first) {
        Aabb box;
        for (int i = first; i <= depth; ++i)
            box = unite(box, bounds(soup.view()[to_prim(static_cast<std::size_t>(i))]));
        return box;
    };
    for (int i = 0; i <= depth; ++i)
        tree.prims.push_back(to_prim(static_cast<std::size_t>(i)));
    for (int level = 0; level < depth; ++level) {
        const std::size_t left = tree.nodes.size();
        tree.nodes.resize(left + 2);
        tree.nodes[at] = Node::inner(box_from(level), to_node(left));
        const auto slot = static_cast<std::uint32_t>(level);
        tree.nodes[left] = Node::leaf(bounds(soup.view()[PrimId{slot}]), slot, 1);
        at = left + 1;
    }
    tree.nodes[at] = Node::leaf(box_from(depth), static_cast<std::uint32_t>(depth), 1);
    const PackedTriangles triangles(tree, soup.view());
    const Ray up{{0.25F, 0.25F, -1}, {0, 0, 1}};
    const Ray from_above{{0.25F, 0.25F, 100}, {0, 0, -1}};
    EXPECT_EQ(closest_hit(tree, triangles, up)->prim, PrimId{0});
    // The far child waits at every level of the way down.
    EXPECT_EQ(closest_hit(tree, triangles, from_above)->prim, to_prim(std::size_t{depth}));
}

TEST(ClosestHit, AgreesWithBruteForceOnSoups) {
    int hits = 0;
    for (std::uint64_t i = 0; i < 1500; ++i) {
        Rng rng(11, i);
        const auto how = static_cast<Coordinates>(rng.below(4));
        const Soup soup = random_soup(rng, 64, how);
        const TriangleView view = soup.view();
        const Bvh tree = median_split(view, 1 + i % 4);
        const PackedTriangles packed(tree, view);
        for (int k = 0; k < 20; ++k) {
            const Ray ray = random_ray(rng, soup, how);
            const auto expected = brute_force_closest_hit(view, ray);
            for (const auto& hit :
                 {closest_hit(tree, packed, ray), closest_hit(tree, IndexedTriangles(view), ray)}) {
                ASSERT_EQ(hit.has_value(), expected.has_value()) << i << ' ' << k;
                if (!hit) continue;
                ++hits;
                ASSERT_EQ(hit->t, expected->t) << i << ' ' << k;
                ASSERT_EQ(hit->prim, expected->prim) << i << ' ' << k;
                ASSERT_EQ(hit->u, expected->u) << i << ' ' << k;
                ASSERT_EQ(hit->v, expected->v) << i << ' ' << k;
                ASSERT_EQ(hit->front, expected->front) << i << ' ' << k;
            }
        }
    }
    EXPECT_GT(hits, 10000);
}

TEST(ClosestHit, FastKernelFindsWhatTheExactOneFindsAwayFromEdges) {
    const Soup soup = stack_of(20);
    const Bvh tree = median_split(soup.view());
    const auto hit = closest_hit<FastKernel>(
        tree, IndexedTriangles(soup.view()), {{0.25F, 0.25F, 50}, {0, 0, -1}}
    );
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->prim, PrimId{19});
    EXPECT_EQ(hit->t, 31);
}

TEST(ClosestHit, BatchGivesTheSameForAnyNumberOfThreads) {
    Rng rng(5);
    const Soup soup = random_soup(rng, 64, Coordinates::smooth);
    const Bvh tree = median_split(soup.view());
    const IndexedTriangles triangles(soup.view());
    std::vector<Ray> rays;
    for (int i = 0; i < 5000; ++i)
        rays.push_back(random_ray(rng, soup, Coordinates::smooth));
    std::vector<Hit> hits(rays.size());
    closest_hits(tree, triangles, rays, hits, Executor(3));
    std::size_t misses = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const auto expected = closest_hit(tree, triangles, rays[i]);
        ASSERT_EQ(hits[i].prim, expected ? expected->prim : no_prim);
        ASSERT_EQ(hits[i].t, expected ? expected->t : std::numeric_limits<float>::infinity());
        if (!expected) ++misses;
    }
    EXPECT_GT(misses, 0U);
    EXPECT_LT(misses, rays.size());
    EXPECT_THROW(closest_hits(tree, triangles, rays, {}), Error);
}

} // namespace
} // namespace raywise
