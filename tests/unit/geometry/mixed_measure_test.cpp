#include <raywise/geometry/mixed_measure.hpp>

#include <gtest/gtest.h>

namespace raywise {
namespace {

constexpr Aabb root{{0, 0, 0}, {4, 4, 4}};
constexpr Aabb corner{{0, 0, 0}, {2, 2, 2}};
constexpr Aabb unseen{{3, 3, 3}, {4, 4, 4}};

/// Sees the half x < 2 only, and remembers how often it was narrowed.
struct HalfMeasure {
    int times_narrowed = 0;

    float operator()(const Aabb& box) const {
        return box.is_empty() || box.lo.x >= 2 ? 0.F : 10.F * (box.hi.z - box.lo.z);
    }

    [[nodiscard]] HalfMeasure narrowed(const Aabb&) const { return {times_narrowed + 1}; }
};

struct BlindMeasure {
    float operator()(const Aabb&) const { return 0; }
};

static_assert(NarrowableMeasure<MixedMeasure<HalfMeasure>>);
static_assert(!NarrowableMeasure<MixedMeasure<BlindMeasure>>);

TEST(MixedMeasure, IsTheWeightedSumOfConditionalProbabilities) {
    const MixedMeasure mixed(HalfMeasure{}, root, 0.1);
    EXPECT_FLOAT_EQ(mixed(root), 1);
    EXPECT_FLOAT_EQ(mixed(corner), 0.9F * 0.5F + 0.1F * 0.25F);
    EXPECT_FLOAT_EQ(mixed(unseen), 0.1F / 16);
    EXPECT_EQ(mixed(Aabb{}), 0);
}

TEST(MixedMeasure, SharesOfZeroAndOneAreThePureMeasures) {
    EXPECT_FLOAT_EQ(MixedMeasure(HalfMeasure{}, root, 0)(corner), 0.5F);
    EXPECT_EQ(MixedMeasure(HalfMeasure{}, root, 0)(unseen), 0);
    EXPECT_FLOAT_EQ(MixedMeasure(HalfMeasure{}, root, 1)(corner), 0.25F);
}

TEST(MixedMeasure, PartsWithoutMassAtTheRootCountNothing) {
    EXPECT_FLOAT_EQ(MixedMeasure(BlindMeasure{}, root, 0.1)(corner), 0.1F * 0.25F);
    constexpr Aabb point{{1, 1, 1}, {1, 1, 1}};
    EXPECT_EQ(MixedMeasure(BlindMeasure{}, point, 0.1)(point), 0);
    EXPECT_EQ(MixedMeasure(BlindMeasure{}, Aabb{}, 0.1)(Aabb{}), 0);
}

TEST(MixedMeasure, NarrowingKeepsTheScale) {
    const MixedMeasure mixed(HalfMeasure{}, root);
    EXPECT_EQ(mixed.narrowed(corner)(corner), mixed(corner));
}

} // namespace
} // namespace raywise
