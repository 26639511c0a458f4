#include <raywise/trace/brute_force.hpp>

#include "support/exact_oracle.hpp"
#include "support/soup.hpp"

#include <raywise/core/rng.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace raywise {
namespace {

using namespace test_support;

TEST(BruteForce, NoTrianglesNoHits) {
    const Ray ray{{0, 0, 0}, {1, 0, 0}};
    EXPECT_EQ(brute_force_closest_hit({}, ray), std::nullopt);
    EXPECT_FALSE(brute_force_any_hit({}, ray));
    EXPECT_TRUE(brute_force_all_hits({}, ray).empty());
}

TEST(BruteForce, AgreesWithRationalArithmeticOnSoups) {
    std::size_t seen = 0;
    for (std::uint64_t i = 0; i < 400; ++i) {
        Rng rng(14, i);
        const auto how = static_cast<Coordinates>(rng.below(4));
        const Soup soup = random_soup(rng, 12, how);
        for (int k = 0; k < 5; ++k) {
            const Ray ray = random_ray(rng, soup, how);
            std::vector<Hit> expected;
            for (std::size_t id = 0; is_valid(ray) && id < soup.view().size(); ++id)
                if (const auto hit = oracle::intersect(ray, soup.view()[to_prim(id)], to_prim(id)))
                    expected.push_back(*hit);
            std::sort(expected.begin(), expected.end(), is_closer);
            const std::vector<Hit> hits = brute_force_all_hits(soup.view(), ray);
            ASSERT_EQ(hits.size(), expected.size()) << i << ' ' << k;
            for (std::size_t h = 0; h < hits.size(); ++h) {
                ASSERT_EQ(hits[h].t, expected[h].t) << i << ' ' << k;
                ASSERT_EQ(hits[h].prim, expected[h].prim) << i << ' ' << k;
            }
            const auto closest = brute_force_closest_hit(soup.view(), ray);
            ASSERT_EQ(closest.has_value(), !expected.empty());
            ASSERT_EQ(brute_force_any_hit(soup.view(), ray), !expected.empty());
            if (closest) {
                ASSERT_EQ(closest->prim, expected.front().prim) << i << ' ' << k;
            }
            seen += hits.size();
        }
    }
    EXPECT_GT(seen, 800U);
}

} // namespace
} // namespace raywise
