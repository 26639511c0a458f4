#include <raywise/analysis/overlap.hpp>

#include <raywise/core/rng.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace raywise {
namespace {

/// A root over two leaves.
Bvh pair_of(const Aabb& left, const Aabb& right) {
    Bvh tree;
    tree.nodes = {
        Node::inner(unite(left, right), NodeId{1}), Node::leaf(left, 0, 1), Node::leaf(right, 1, 1)
    };
    tree.prims = {PrimId{0}, PrimId{1}};
    return tree;
}

/// Parallel rays along +z through [-10, 10]^2 at z = -10.
Distribution along_z() {
    return ParallelDistribution(ParallelParams{
        .point = {0, 0, -10}, .frame = frame_along({0, 0, 1}), .half_width = 10, .half_height = 10
    });
}

/// A pinhole at the origin that looks along +z with a field of view of 90 degrees.
RadialParams at_origin() {
    return {.eye = {}, .frame = frame_along({0, 0, 1}), .window = RadialWindow{}};
}

std::vector<Ray> draw(const Distribution& distribution, std::size_t count) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(3, i);
        rays.push_back(sample(distribution, rng));
    }
    return rays;
}

TEST(SiblingOverlap, OfAnEmptyTreeIsZero) {
    const SiblingOverlap none = *measure_overlap(Bvh{}, along_z());
    EXPECT_EQ(none.levels(), 0);
    EXPECT_EQ(none.all(), 0);
    EXPECT_EQ(none.at(0), 0);
    EXPECT_EQ(measure_overlap(Bvh{}, std::vector<Ray>{}).all(), 0);
}

TEST(SiblingOverlap, SumsMassesBeforeDividing) {
    SiblingOverlap overlap;
    overlap.add(0, {.left = 10, .right = 4, .shared = 2});
    overlap.add(2, {.left = 1, .right = 1, .shared = 1});
    overlap.add(2, {.left = 0, .right = 5, .shared = 0});
    EXPECT_DOUBLE_EQ(overlap.at(0), 0.5);
    EXPECT_EQ(overlap.at(1), 0);
    EXPECT_DOUBLE_EQ(overlap.at(2), 1);
    EXPECT_DOUBLE_EQ(overlap.up_to(1), 0.5);
    EXPECT_DOUBLE_EQ(overlap.up_to(2), 3.0 / 5);
    EXPECT_DOUBLE_EQ(overlap.all(), 3.0 / 5);
}

TEST(SiblingOverlap, SeesBoxesOneBehindTheOtherAsOneAndSideBySideAsTwo) {
    const Aabb front{{0, 0, 0}, {1, 1, 1}};
    EXPECT_NEAR(measure_overlap(pair_of(front, {{0, 0, 5}, {1, 1, 6}}), along_z())->all(), 1, 1e-6);
    EXPECT_EQ(measure_overlap(pair_of(front, {{2, 0, 0}, {3, 1, 1}}), along_z())->all(), 0);
    const Bvh half = pair_of(front, {{0.5F, 0, 5}, {1.5F, 1, 6}});
    EXPECT_NEAR(measure_overlap(half, along_z())->all(), 0.5, 1e-6);
}

TEST(SiblingOverlap, CulledCountsOnlyWhatTheWindowSees) {
    // Half of the left box is outside the window, and that half is what they share.
    const Bvh tree = pair_of({{9, 0, 0}, {11, 1, 1}}, {{10, 0, 2}, {12, 1, 3}});
    EXPECT_EQ(measure_overlap(tree, along_z(), Culling::culled)->all(), 0);
    EXPECT_NEAR(measure_overlap(tree, along_z(), Culling::unculled)->all(), 0.5, 1e-6);
}

TEST(SiblingOverlap, ForAPinholeIsTheOverlapOfPerspectiveShadows) {
    // The far box is twice as large and twice as far: the same shadow.
    const Bvh tree = pair_of({{-0.5F, -0.5F, 2}, {0.5F, 0.5F, 2}}, {{-1, -1, 4}, {1, 1, 4}});
    const Distribution pinhole = RadialDistribution(at_origin());
    EXPECT_NEAR(measure_overlap(tree, pinhole)->all(), 1, 1e-6);
    EXPECT_NEAR(measure_overlap(tree, pinhole, Culling::unculled)->all(), 1, 1e-6);
}

TEST(SiblingOverlap, BySampledRaysConvergesToThatByShadows) {
    const Bvh tree = pair_of({{-3, -2, 4}, {1, 2, 6}}, {{-1, -1, 5}, {4, 3, 8}});
    for (const Distribution& rays : {along_z(), Distribution(RadialDistribution(at_origin()))}) {
        const double exact = measure_overlap(tree, rays)->all();
        EXPECT_GT(exact, 0.1);
        // Some 4000 of the rays meet the smaller box: four standard errors.
        EXPECT_NEAR(measure_overlap(tree, draw(rays, 100'000)).all(), exact, 0.03);
    }
}

TEST(SiblingOverlap, HasNoShadowFormForUniformAndIsotropicRays) {
    const Bvh tree = pair_of({{0, 0, 1}, {1, 1, 2}}, {{2, 0, 1}, {3, 1, 2}});
    RadialParams isotropic = at_origin();
    isotropic.emission = Emission::isotropic;
    const Distribution lamp = RadialDistribution(isotropic);
    EXPECT_FALSE(measure_overlap(tree, lamp));
    EXPECT_TRUE(measure_overlap(tree, lamp, Culling::culled, MeasureMode::thesis));
    EXPECT_FALSE(measure_overlap(tree, UniformDistribution(tree.root().box())));
}

TEST(SiblingOverlap, BySampledRaysIsTheSameForAnyNumberOfThreads) {
    const Bvh tree = pair_of({{-3, -2, 4}, {1, 2, 6}}, {{-1, -1, 5}, {4, 3, 8}});
    const std::vector<Ray> rays = draw(along_z(), 20'000);
    EXPECT_EQ(measure_overlap(tree, rays).all(), measure_overlap(tree, rays, Executor(3)).all());
}

} // namespace
} // namespace raywise
