// Batches answer like single queries, whether their rays go together or not.
#include "support/simd_target.hpp"
#include "support/soup.hpp"
#include "support/wide_tree.hpp"

#include <raywise/bvh/box_frame.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/trace/wide.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace raywise {
namespace {

using namespace test_support;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Every test runs on every instruction set of this machine.
class WideBatch : public OnSimdTarget {};

INSTANTIATE_TEST_SUITE_P(Targets, WideBatch, testing::ValuesIn(simd_targets()), name_of_target);

/// Some `count` rays close to the given one, each with an interval and an exclusion of its own.
std::vector<Ray> rays_around(const Ray& middle, std::size_t count, std::size_t prims, Rng& rng) {
    const float spread = std::exp2(-3 - static_cast<float>(rng.below(24)));
    const auto moved = [&](Vec3 v) {
        for (int axis = 0; axis < 3; ++axis)
            v[axis] *= 1 + spread * (2 * rng.uniform() - 1);
        return v;
    };
    std::vector<Ray> rays(count, middle);
    for (Ray& ray : rays) {
        if (rng.below(4) != 0) ray.origin = moved(ray.origin);
        if (rng.below(4) != 0) ray.direction = moved(ray.direction);
        if (rng.below(4) == 0) ray.t_max = infinity;
        if (rng.below(8) == 0) ray.excluded = to_prim(static_cast<std::size_t>(rng.below(prims)));
    }
    return rays;
}

/// Returns how many of them hit something.
std::size_t expect_batches_like_single_queries(const WideBvh& tree, const std::vector<Ray>& rays) {
    std::vector<Hit> hits(rays.size());
    closest_hits(tree, rays, hits);
    const auto occluded = std::make_unique<bool[]>(rays.size());
    any_hits(tree, rays, {occluded.get(), rays.size()});
    std::size_t found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit expected = closest_hit(tree, rays[i]).value_or(Hit{});
        EXPECT_EQ(hits[i].prim, expected.prim) << i;
        EXPECT_EQ(hits[i].t, expected.t) << i;
        EXPECT_EQ(hits[i].u, expected.u) << i;
        EXPECT_EQ(hits[i].v, expected.v) << i;
        EXPECT_EQ(hits[i].front, expected.front) << i;
        EXPECT_EQ(occluded[i], expected.prim != no_prim) << i;
        found += expected.prim != no_prim ? 1 : 0;
    }
    return found;
}

TEST_P(WideBatch, OfNoRaysOrOfAnEmptyTreeAnswersNothing) {
    EXPECT_EQ(expect_batches_like_single_queries(WideBvh{}, {}), 0U);
    EXPECT_EQ(expect_batches_like_single_queries(WideBvh{}, std::vector<Ray>(40)), 0U);
    Soup soup;
    soup.add({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
    EXPECT_EQ(expect_batches_like_single_queries(wide_tree(soup.view()), {}), 0U);
}

TEST_P(WideBatch, AnswersInvalidRaysAmongOthersAsMisses) {
    Soup soup;
    soup.add({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
    const WideBvh tree = wide_tree(soup.view());
    const Ray good{{0.1F, 0.2F, 3}, {0.01F, 0.02F, -1}};
    const std::array bad{
        Ray{{nan, 0, 0}, {0.01F, 0.02F, -1}},
        Ray{{0, 0, 3}, {0.01F, 0.02F, nan}},
        Ray{{0, 0, 3}, {0, -0.0F, 0}},
        Ray{{infinity, 0, 3}, {0.01F, 0.02F, -1}},
        Ray{{0, 0, 3}, {0.01F, 0.02F, -infinity}},
        Ray{{0, 0, 3}, {0.01F, 0.02F, -1}, 2, 1},
        Ray{{0, 0, 3}, {0.01F, 0.02F, -1}, nan, 1},
        Ray{{0, 0, 3}, {0.01F, 0.02F, -1}, 0, nan},
        Ray{{0, 0, 3}, {0.01F, 0.02F, -1}, -1, 9}
    };
    for (const Ray& ray : bad)
        for (std::size_t at = 0; at < 40; at += 13) {
            std::vector<Ray> rays(40, good);
            rays[at] = ray;
            EXPECT_EQ(expect_batches_like_single_queries(tree, rays), 39U);
        }
}

TEST_P(WideBatch, AnswersRaysThatGoTogetherLikeSingleQueries) {
    std::size_t hits = 0;
    for (std::uint64_t i = 0; i < 500; ++i) {
        Rng rng(31, i);
        const auto how = static_cast<Coordinates>(rng.below(4));
        const Soup soup = random_soup(rng, 64, how);
        const std::size_t leaf_size = 1 + i % 9;
        const auto slope = [&] { return 2 * static_cast<double>(rng.uniform()) - 1; };
        const Vec3d axis{slope(), slope(), slope()};
        const WideBvh tree = i % 3 == 0 ? framed_tree(soup.view(), box_frame_along(axis), leaf_size)
                                        : wide_tree(soup.view(), leaf_size, 1 + i % 2);
        std::vector<Ray> rays;
        for (int k = 0; k < 6; ++k) {
            Ray middle = random_ray(rng, soup, how);
            if (i % 3 == 0 && k % 2 == 0) middle.direction = to_float(axis);
            const auto around = rays_around(middle, 48, soup.corners.size(), rng);
            rays.insert(rays.end(), around.begin(), around.end());
        }
        hits += expect_batches_like_single_queries(tree, rays);
        ASSERT_FALSE(HasFailure()) << i;
    }
    EXPECT_GT(hits, 7000U);
}

/// Most triangles of a fan are in doubt for rays through its top.
TEST_P(WideBatch, AnswersRaysThroughOneVertexLikeSingleQueries) {
    constexpr int count = 60;
    const Vec3 top{0.1F, 0.2F, 0.3F};
    const auto rim = [](int i) {
        const float angle = 6.2831853F * static_cast<float>(i % count) / count;
        return Vec3{std::cos(angle), std::sin(angle), -1};
    };
    Soup soup;
    for (int i = 0; i < count; ++i)
        soup.add({rim(i), rim(i + 1), top});
    const WideBvh tree = wide_tree(soup.view());
    Rng rng(32);
    std::vector<Ray> rays;
    for (int i = 0; i < 512; ++i) {
        Ray ray{{0.4F + 0.01F * rng.uniform(), 0.5F + 0.01F * rng.uniform(), 3}, {}};
        ray.direction = (rng.below(2) == 0 ? top : rim(i) * 0.5F) - ray.origin;
        rays.push_back(ray);
    }
    EXPECT_GT(expect_batches_like_single_queries(tree, rays), 256U);
}

} // namespace
} // namespace raywise
