#include <raywise/geometry/aabb.hpp>

#include <raywise/core/rng.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace raywise {
namespace {

constexpr float most = std::numeric_limits<float>::max();
constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
const Aabb unit{{0, 0, 0}, {1, 1, 1}};

TEST(Aabb, TheEmptyBoxOverlapsAndContainsNothingAndIsTheIdentityOfUnite) {
    const Aabb empty;
    EXPECT_TRUE(empty.is_empty());
    EXPECT_FALSE(overlaps(empty, unit));
    EXPECT_FALSE(overlaps(empty, Aabb{{-most, -most, -most}, {most, most, most}}));
    EXPECT_FALSE(contains(empty, unit));
    EXPECT_FALSE(contains(unit, empty));
    EXPECT_EQ(unite(empty, unit), unit);
    EXPECT_EQ(SurfaceMeasure{}(empty), 0.0F);
}

TEST(Aabb, PointsAndFlatBoxesAreValidAndTouchingCounts) {
    const Aabb point{{1, 1, 1}, {1, 1, 1}};
    const Aabb flat{{0, 1, 0}, {1, 1, 1}};
    EXPECT_FALSE(point.is_empty());
    EXPECT_TRUE(overlaps(point, unit));
    EXPECT_TRUE(contains(unit, point));
    EXPECT_TRUE(overlaps(flat, unit));
    EXPECT_EQ(half_area(point), 0.0F);
    EXPECT_EQ(half_area(flat), 1.0F);
}

TEST(Aabb, NaNMakesEveryPredicateFalse) {
    for (int axis = 0; axis < 3; ++axis) {
        Aabb broken = unit;
        broken.lo[axis] = nan_value;
        EXPECT_TRUE(broken.is_empty());
        EXPECT_FALSE(overlaps(broken, unit));
        EXPECT_FALSE(overlaps(unit, broken));
        EXPECT_FALSE(contains(unit, broken));
        EXPECT_FALSE(contains(broken, unit));
    }
}

TEST(Aabb, VertexIAndItsComplementAreOpposite) {
    EXPECT_EQ(unit.vertex(4), (Vec3{1, 0, 0}));
    EXPECT_EQ(unit.vertex(2), (Vec3{0, 1, 0}));
    EXPECT_EQ(unit.vertex(1), (Vec3{0, 0, 1}));
    for (int i = 0; i < 8; ++i)
        EXPECT_EQ(unit.vertex(i) + unit.vertex(7 - i), (Vec3{1, 1, 1}));
}

TEST(Aabb, CenterOfTheLargestBoxIsFinite) {
    EXPECT_EQ((Aabb{{-most, -most, most}, {most, most, most}}).center(), (Vec3{0, 0, most}));
}

TEST(Aabb, OverlapIsTheSameAsANonEmptyIntersectionOnRandomBoxes) {
    for (std::uint64_t i = 0; i < 10'000; ++i) {
        Rng rng(1, i);
        // Few distinct coordinates, so that touching and flat boxes are common.
        const auto coordinate = [&] { return static_cast<float>(rng.below(5)); };
        const auto box = [&] {
            const Vec3 a{coordinate(), coordinate(), coordinate()};
            const Vec3 b{coordinate(), coordinate(), coordinate()};
            return Aabb{min(a, b), max(a, b)};
        };
        const Aabb a = box();
        const Aabb b = box();
        EXPECT_EQ(overlaps(a, b), !intersect(a, b).is_empty());
        EXPECT_EQ(contains(a, b), unite(a, b) == a);
        EXPECT_LE(half_area(intersect(a, b)), half_area(a));
    }
}

} // namespace
} // namespace raywise
