#include <raywise/analysis/estimated_cost.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace raywise {
namespace {

const Aabb whole{{0, 0, 0}, {4, 1, 1}};
const Aabb left{{0, 0, 0}, {1, 1, 1}};
const Aabb right{{2, 0, 0}, {4, 1, 1}};

/// A root over a leaf of two and a leaf of three primitives.
Bvh three_nodes() {
    Bvh tree;
    tree.nodes = {Node::inner(whole, NodeId{1}), Node::leaf(left, 0, 2), Node::leaf(right, 2, 3)};
    for (std::uint32_t i = 0; i < 5; ++i)
        tree.prims.push_back(static_cast<PrimId>(i));
    return tree;
}

/// The probability of a ray along x, y or z through [0, 10]^2.
struct AxisMeasure {
    int axis = 0;

    float operator()(const Aabb& box) const {
        const Vec3 s = box.size();
        return s[(axis + 1) % 3] * s[(axis + 2) % 3] / 100;
    }
};

TEST(EstimateCost, OfAnEmptyTreeIsZero) {
    EXPECT_EQ(estimate_cost(Bvh{}, SurfaceMeasure{}, Normalization::conditional).total(), 0);
}

TEST(EstimateCost, OfARootThatNoRayMeetsIsZero) {
    const auto nothing = [](const Aabb&) { return 0.0F; };
    EXPECT_EQ(estimate_cost(three_nodes(), nothing, Normalization::conditional).total(), 0);
    EXPECT_EQ(estimate_cost(three_nodes(), nothing, Normalization::absolute).total(), 0);
}

TEST(EstimateCost, UnderSurfaceAreaIsTheSumWorkedOutByHand) {
    const EstimatedCost cost =
        estimate_cost(three_nodes(), SurfaceMeasure{}, Normalization::conditional);
    EXPECT_DOUBLE_EQ(cost.inner, 2);
    // Half areas: 9 of the root, 3 and 5 of the leaves.
    EXPECT_NEAR(cost.leaves, 1.2 * (2 * 3.0 + 3 * 5.0) / 9, 1e-12);
    EXPECT_DOUBLE_EQ(cost.total(), cost.inner + cost.leaves);
}

TEST(EstimateCost, AbsoluteCountsTheRaysThatMissTheRoot) {
    // Along x all three boxes cast the same shadow of 1 in 100.
    const EstimatedCost absolute =
        estimate_cost(three_nodes(), AxisMeasure{0}, Normalization::absolute);
    EXPECT_NEAR(absolute.total(), 0.01 * (2 + 1.2 * 5), 1e-7);
    const EstimatedCost conditional =
        estimate_cost(three_nodes(), AxisMeasure{0}, Normalization::conditional);
    EXPECT_NEAR(conditional.total(), 2 + 1.2 * 5, 1e-5);
}

TEST(EstimateCost, TakesItsConstantsFromTheCaller) {
    const CostConstants constants{.node = 10, .prim = 1};
    const EstimatedCost cost =
        estimate_cost(three_nodes(), AxisMeasure{1}, Normalization::conditional, constants);
    EXPECT_NEAR(cost.inner, 20, 1e-5);
    EXPECT_NEAR(cost.leaves, (2 * 1.0 + 3 * 2.0) / 4, 1e-5);
}

TEST(EstimateError, IsAFractionOfTheEstimate) {
    EXPECT_DOUBLE_EQ(estimate_error(12, 10), 0.2);
    EXPECT_DOUBLE_EQ(estimate_error(8, 10), 0.2);
    EXPECT_EQ(estimate_error(0, 0), 0);
    EXPECT_TRUE(std::isinf(estimate_error(1, 0)));
}

} // namespace
} // namespace raywise
