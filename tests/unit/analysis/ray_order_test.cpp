#include <raywise/analysis/ray_order.hpp>

#include <raywise/core/rng.hpp>
#include <raywise/geometry/sampling.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace raywise {
namespace {

constexpr RayOrder all_orders[] =
    {RayOrder::origin, RayOrder::octant_origin, RayOrder::direction, RayOrder::across_direction};

std::vector<Ray> random_rays(std::size_t count) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(3, i);
        const Aabb box{{-1, 2, 5}, {4, 3, 9}};
        rays.push_back({.origin = sample_box(box, rng), .direction = to_float(sample_sphere(rng))});
    }
    return rays;
}

/// Mean distance of neighbors, by origin or by direction.
double roughness(
    const std::vector<Ray>& rays,
    const std::vector<std::uint32_t>& places,
    Vec3 Ray::* what
) {
    double sum = 0;
    for (std::size_t i = 1; i < places.size(); ++i)
        sum += length(to_double(rays[places[i]].*what - rays[places[i - 1]].*what));
    return sum / static_cast<double>(places.size());
}

TEST(SortedPlaces, AreAPermutationWhateverTheOrder) {
    const std::vector<Ray> rays = random_rays(5000);
    for (const RayOrder order : all_orders) {
        std::vector<std::uint32_t> places = sorted_places(rays, order);
        std::sort(places.begin(), places.end());
        for (std::uint32_t i = 0; i < places.size(); ++i)
            ASSERT_EQ(places[i], i) << name_of(order);
        ASSERT_EQ(places.size(), rays.size());
    }
}

TEST(SortedPlaces, NoRaysOneRayAndEqualRaysStayAsTheyAre) {
    for (const RayOrder order : all_orders) {
        EXPECT_TRUE(sorted_places({}, order).empty());
        EXPECT_EQ(sorted_places(random_rays(1), order), std::vector<std::uint32_t>{0});
        const std::vector<Ray> equal(7, Ray{.origin = {1, 2, 3}, .direction = {0, 0, 1}});
        std::vector<std::uint32_t> in_turn(7);
        std::iota(in_turn.begin(), in_turn.end(), 0U);
        EXPECT_EQ(sorted_places(equal, order), in_turn) << name_of(order);
    }
}

TEST(SortedPlaces, InvalidRaysAreSortedWithTheOthers) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    std::vector<Ray> rays = random_rays(10);
    rays[2] = {};
    rays[3].origin = {nan, 0, 0};
    rays[4].direction = {nan, nan, nan};
    rays[5].origin = {infinity, -infinity, 0};
    for (const RayOrder order : all_orders) {
        std::vector<std::uint32_t> places = sorted_places(rays, order);
        std::sort(places.begin(), places.end());
        EXPECT_EQ(std::unique(places.begin(), places.end()) - places.begin(), 10) << name_of(order);
    }
}

TEST(SortedPlaces, BringWhatTheOrderIsAboutTogether) {
    const std::vector<Ray> rays = random_rays(20000);
    std::vector<std::uint32_t> given(rays.size());
    std::iota(given.begin(), given.end(), 0U);
    EXPECT_LT(
        roughness(rays, sorted_places(rays, RayOrder::origin), &Ray::origin),
        0.1 * roughness(rays, given, &Ray::origin)
    );
    EXPECT_LT(
        roughness(rays, sorted_places(rays, RayOrder::direction), &Ray::direction),
        0.05 * roughness(rays, given, &Ray::direction)
    );
    const std::vector<std::uint32_t> by_octant = sorted_places(rays, RayOrder::octant_origin);
    int changes = 0;
    for (std::size_t i = 1; i < by_octant.size(); ++i) {
        const Vec3 a = rays[by_octant[i - 1]].direction;
        const Vec3 b = rays[by_octant[i]].direction;
        changes += (a.x < 0) != (b.x < 0) || (a.y < 0) != (b.y < 0) || (a.z < 0) != (b.z < 0);
    }
    EXPECT_EQ(changes, 7);
}

TEST(SortedPlaces, AcrossTheDirectionDepthDoesNotCount) {
    std::vector<Ray> rays = random_rays(10000);
    for (Ray& ray : rays)
        ray.direction = {0, 0, -1};
    std::vector<Ray> flat = rays;
    for (Ray& ray : flat)
        ray.origin.z = 0;
    EXPECT_EQ(
        sorted_places(rays, RayOrder::across_direction),
        sorted_places(flat, RayOrder::across_direction)
    );
}

} // namespace
} // namespace raywise
