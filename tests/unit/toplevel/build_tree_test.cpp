#include <raywise/toplevel/build_tree.hpp>

#include "support/random_areas.hpp"

#include <raywise/bvh/validate.hpp>
#include <raywise/core/error.hpp>
#include <raywise/trace/brute_force.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <numeric>

namespace raywise {
namespace {

using test_support::random_soup;

constexpr std::array
    measures{MeasureKind::surface, MeasureKind::area, MeasureKind::mixed, MeasureKind::counted};
constexpr std::array axes{AxisChoice::longest, AxisChoice::facing, AxisChoice::all};
constexpr std::array builders{BuilderKind::binned, BuilderKind::sweep, BuilderKind::guided};

std::vector<Distribution> one_of_each_kind(Rng& rng) {
    const Region region = Obb{{0, 0, 0}, frame_along({1, 2, 3}), {5, 5, 5}};
    std::vector<Distribution> all;
    for (std::size_t kind = 0; kind < std::variant_size_v<Distribution>;) {
        Distribution next = test_support::random_distribution(rng, region);
        if (next.index() != kind) continue;
        all.push_back(std::move(next));
        ++kind;
    }
    return all;
}

bool is_equal(const Bvh& a, const Bvh& b) {
    return a.prims == b.prims && a.nodes.size() == b.nodes.size() &&
           std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(Node)) == 0;
}

TEST(BuildTree, EveryPairOfHeuristicsMakesAValidTreeThatAnswersLikeBruteForce) {
    Rng rng(51);
    const Scene scene = random_soup(rng, 150);
    const BuildInput input = build_input_of(scene.view());
    const auto distributions = one_of_each_kind(rng);
    std::vector<Ray> rays;
    for (int i = 0; i < 60; ++i)
        rays.push_back(test_support::random_ray(rng, scene, {}));
    for (const Distribution& distribution : distributions) {
        for (const auto measure : measures) {
            for (const auto axis : axes) {
                for (const auto builder : builders) {
                    Heuristic heuristic;
                    heuristic.measure = measure;
                    heuristic.axes = axis;
                    heuristic.builder = builder;
                    heuristic.counted_rays = 64;
                    const BuiltTree built = build_tree(input, distribution, heuristic);
                    ASSERT_NO_THROW(validate(built.tree, input.boxes));
                    ASSERT_EQ(built.report.inner_nodes > 0, builder == BuilderKind::guided);
                    const PackedTriangles triangles(built.tree, scene.view());
                    for (const Ray& ray : rays) {
                        const auto expected = brute_force_closest_hit(scene.view(), ray);
                        const auto hit = closest_hit(built.tree, triangles, ray);
                        ASSERT_EQ(hit.has_value(), expected.has_value());
                        ASSERT_TRUE(!hit || (hit->t == expected->t && hit->prim == expected->prim));
                    }
                }
            }
        }
    }
}

TEST(BuildTree, OverNoBoxesIsEmpty) {
    Rng rng(52);
    for (const Distribution& distribution : one_of_each_kind(rng)) {
        EXPECT_TRUE(build_tree(BuildInput{}, distribution).tree.is_empty());
    }
    EXPECT_TRUE(build_tree(BuildInput{}, surface_area_heuristic()).tree.is_empty());
}

TEST(BuildTree, EqualsTheBuilderCalledByHand) {
    Rng rng(53);
    const Scene scene = random_soup(rng, 300);
    const BuildInput input = build_input_of(scene.view());
    const ParallelDistribution sun({.point = {0, 9, 0}, .frame = frame_along({1, -3, 1})});
    Heuristic pure;
    pure.measure = MeasureKind::area;
    EXPECT_TRUE(is_equal(
        build_tree(input, Distribution(sun), pure).tree, build_binned(input.boxes, sun.measure())
    ));
    EXPECT_TRUE(is_equal(
        build_tree(input, surface_area_heuristic()).tree,
        build_binned(input.boxes, SurfaceMeasure{})
    ));
    // The pairs differ: the choice is not lost on the way.
    Heuristic surface = surface_area_heuristic();
    EXPECT_FALSE(is_equal(
        build_tree(input, Distribution(sun), pure).tree,
        build_tree(input, Distribution(sun), surface).tree
    ));
    Heuristic longest = surface;
    longest.axes = AxisChoice::longest;
    EXPECT_FALSE(is_equal(
        build_tree(input, Distribution(sun), longest).tree,
        build_tree(input, Distribution(sun), surface).tree
    ));
    Heuristic facing = longest;
    facing.axes = AxisChoice::facing;
    EXPECT_FALSE(is_equal(
        build_tree(input, Distribution(sun), longest).tree,
        build_tree(input, Distribution(sun), facing).tree
    ));
}

TEST(BuildTree, FacingNeverSplitsAcrossAxisParallelRays) {
    // A grid of unit boxes: along z is the longest side, but it faces the rays.
    BuildInput input;
    for (int x = 0; x < 4; ++x) {
        for (int y = 0; y < 4; ++y) {
            for (int z = 0; z < 16; ++z) {
                const Vec3 lo{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
                input.boxes.push_back({lo, lo + Vec3{0.5F, 0.5F, 0.5F}});
                input.centroids.push_back(input.boxes.back().center());
            }
        }
    }
    const ParallelDistribution along_z(
        {.point = {2, 2, -1}, .frame = frame_along({0, 0, 1}), .half_width = 3, .half_height = 3}
    );
    Heuristic heuristic;
    heuristic.axes = AxisChoice::facing;
    const Bvh tree = build_tree(input, Distribution(along_z), heuristic).tree;
    for (const Node& node : tree.nodes) {
        // Nothing is cut along z until a node is a single column, which nothing else can divide.
        const Vec3 size = node.box().size();
        EXPECT_TRUE(size.z == 15.5F || (size.x == 0.5F && size.y == 0.5F));
    }
    heuristic.axes = AxisChoice::longest;
    const Bvh other = build_tree(input, Distribution(along_z), heuristic).tree;
    EXPECT_LT(other[other.root().left()].box().size().z, 15.5F);
}

TEST(BuildTree, IsTheSameForAnyNumberOfThreads) {
    Rng rng(54);
    const Scene scene = random_soup(rng, 6000);
    const Executor four(4);
    const BuildInput input = build_input_of(scene.view(), four);
    for (const Distribution& distribution : one_of_each_kind(rng)) {
        EXPECT_TRUE(is_equal(
            build_tree(input, distribution).tree, build_tree(input, distribution, {}, four).tree
        ));
    }
}

TEST(BuildInput, HasTheBoxesAndMeansOfTheListedTriangles) {
    const Scene scene =
        test_support::soup_of({{{0, 0, 0}, {3, 0, 0}, {0, 6, 9}}, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}
        );
    const BuildInput all = build_input_of(scene.view());
    ASSERT_EQ(all.boxes.size(), 2U);
    EXPECT_EQ(all.boxes[0], (Aabb{{0, 0, 0}, {3, 6, 9}}));
    EXPECT_EQ(all.centroids[0], (Vec3{1, 2, 3}));
    const std::array second{PrimId{1}};
    const BuildInput one = build_input_of(scene.view(), second);
    ASSERT_EQ(one.boxes.size(), 1U);
    EXPECT_EQ(one.centroids[0], (Vec3{1, 1, 1}));
}

TEST(BuildTree, RefusesParametersOutOfRange) {
    const BuildInput input{{Aabb{{0, 0, 0}, {1, 1, 1}}}, {{0.5F, 0.5F, 0.5F}}};
    const auto refused = [&](const Heuristic& heuristic) {
        EXPECT_THROW(static_cast<void>(build_tree(input, heuristic)), Error);
    };
    refused({.surface_share = 1});
    refused({.surface_share = -0.1});
    refused({.counted_rays = 0});
    refused({.axis_threshold = 1.5F});
    refused({.binned = {.bin_count = 1}});
}

} // namespace
} // namespace raywise
