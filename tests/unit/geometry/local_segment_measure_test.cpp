#include <raywise/geometry/local_segment_measure.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/rng.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise {
namespace {

using namespace testing;

constexpr Aabb world{{-2, -2, -2}, {2, 2, 2}};

SegmentMeasure segments(std::size_t count) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(3, i);
        const Vec3 origin = to_float(random_point(rng, 2));
        rays.push_back({origin, to_float(random_point(rng, 1)), 0, rng.uniform()});
    }
    return {rays, world};
}

TEST(LocalSegmentMeasure, IsTheSegmentMeasureBeforeItIsNarrowed) {
    const SegmentMeasure global = segments(200);
    const LocalSegmentMeasure local(global, world);
    EXPECT_EQ(local(Aabb{}), 0.F);
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(5, i);
        const Aabb box = random_box(rng, random_point(rng, 2), 1);
        EXPECT_NEAR(local(box), global(box), 1e-6);
    }
}

TEST(LocalSegmentMeasure, NarrowingKeepsTheMassOfTheBoxAndTheOrderInside) {
    const LocalSegmentMeasure local(segments(200), world);
    for (std::uint64_t i = 0; i < 500; ++i) {
        Rng rng(7, i);
        const Aabb box = random_box(rng, random_point(rng, 2), 1);
        const LocalSegmentMeasure inside = local.narrowed(box);
        EXPECT_NEAR(inside(box), local(box), 1e-6);
        const Aabb part = intersect(box, random_box(rng, random_point(rng, 2), 1));
        EXPECT_LE(inside(part), inside(box) * (1 + 1e-6F));
    }
}

TEST(LocalSegmentMeasure, ANodeThatNoSegmentMeetsIsSplitByItsSurface) {
    const LocalSegmentMeasure local(segments(0), world);
    const Aabb box{{0, 0, 0}, {1, 1, 1}};
    const LocalSegmentMeasure inside = local.narrowed(box);
    EXPECT_NEAR(inside({{0, 0, 0}, {1, 1, 0}}), inside(box) / 3, 1e-6);
}

} // namespace
} // namespace raywise
