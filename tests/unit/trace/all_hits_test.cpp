#include <raywise/trace/all_hits.hpp>

#include "support/median_split.hpp"
#include "support/soup.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/trace/brute_force.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise {
namespace {

using namespace test_support;

TEST(AllHits, EmptyTreeHasNone) {
    EXPECT_TRUE(sorted_hits(Bvh{}, PackedTriangles{}, {{0, 0, 0}, {1, 0, 0}}).empty());
}

TEST(AllHits, TriangleInSeveralSlotsIsListedOnce) {
    Soup soup;
    soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    Bvh tree = median_split(soup.view());
    tree.prims = {PrimId{0}, PrimId{0}, PrimId{0}};
    tree.nodes[0] = Node::leaf(tree.root().box(), 0, 3);
    const Ray ray{{0.25F, 0.25F, 1}, {0, 0, -1}};
    EXPECT_EQ(sorted_hits(tree, PackedTriangles(tree, soup.view()), ray).size(), 1U);
}

TEST(AllHits, AreThoseOfBruteForceInOrder) {
    std::size_t seen = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng rng(13, i);
        const auto how = static_cast<Coordinates>(rng.below(4));
        const Soup soup = random_soup(rng, 64, how);
        const Bvh tree = median_split(soup.view(), 1 + i % 4);
        for (int k = 0; k < 20; ++k) {
            const Ray ray = random_ray(rng, soup, how);
            const std::vector<Hit> expected = brute_force_all_hits(soup.view(), ray);
            const std::vector<Hit> hits = sorted_hits(tree, IndexedTriangles(soup.view()), ray);
            ASSERT_EQ(hits.size(), expected.size()) << i << ' ' << k;
            for (std::size_t h = 0; h < hits.size(); ++h) {
                ASSERT_EQ(hits[h].t, expected[h].t) << i << ' ' << k;
                ASSERT_EQ(hits[h].prim, expected[h].prim) << i << ' ' << k;
            }
            seen += hits.size();
        }
    }
    EXPECT_GT(seen, 10000U);
}

} // namespace
} // namespace raywise
