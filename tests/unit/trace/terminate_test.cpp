#include <raywise/trace/terminate.hpp>

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

TEST(Terminated, RaysEndWhereTheyHitAndOthersStay) {
    Rng rng(1);
    const Soup soup = random_soup(rng, 60, Coordinates::smooth);
    const Bvh tree = median_split(soup.view());
    std::vector<Ray> rays;
    for (int i = 0; i < 2000; ++i)
        rays.push_back(random_ray(rng, soup, Coordinates::smooth));
    for (const int threads : {1, 2}) {
        const std::vector<Ray> cut =
            terminated(tree, IndexedTriangles(soup.view()), rays, Executor(threads));
        ASSERT_EQ(cut.size(), rays.size());
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto hit = brute_force_closest_hit(soup.view(), rays[i]);
            EXPECT_EQ(cut[i].t_max, hit ? hit->t : rays[i].t_max);
            EXPECT_EQ(cut[i].origin, rays[i].origin);
            EXPECT_EQ(cut[i].direction, rays[i].direction);
        }
    }
}

TEST(Terminated, NoRaysGiveNone) {
    EXPECT_TRUE(terminated(Bvh{}, IndexedTriangles(TriangleView{}), {}).empty());
}

} // namespace
} // namespace raywise
