#include <raywise/analysis/ray_class.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <set>
#include <string_view>

namespace raywise {
namespace {

TEST(RayClasses, HaveNamesThatDiffer) {
    std::set<std::string_view> names;
    for (const RayClass rays : all_ray_classes())
        EXPECT_TRUE(names.insert(name_of(rays)).second);
    EXPECT_EQ(names.size(), 8U);
}

TEST(RayClasses, CamerasAskForTheClosestHitAndSunsForAnyAndNoClassIsBoth) {
    std::size_t suns = 0, cameras = 0;
    for (const RayClass rays : all_ray_classes()) {
        EXPECT_TRUE(asks_closest(rays) || !is_camera(rays)) << name_of(rays);
        EXPECT_FALSE(asks_closest(rays) && is_sun(rays)) << name_of(rays);
        suns += is_sun(rays) ? 1U : 0U;
        cameras += is_camera(rays) ? 1U : 0U;
    }
    EXPECT_EQ(suns, 3U);
    EXPECT_EQ(cameras, 2U);
}

} // namespace
} // namespace raywise
