#include <raywise/build/spatial.hpp>

#include "support/soup.hpp"
#include "unit/build/box_sets.hpp"

#include <raywise/build/binned.hpp>
#include <raywise/bvh/statistics.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/hash.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raywise {
namespace {

using namespace testing;
using test_support::Coordinates;
using test_support::Soup;

struct TriangleSet {
    std::string name;
    Soup soup;
};

/// A triangle in each box: across the diagonal, so that cuts shrink it.
Soup triangles_in(const std::vector<Aabb>& boxes) {
    Soup soup;
    for (const Aabb& box : boxes)
        soup.add({box.lo, box.hi, {box.lo.x, box.hi.y, box.lo.z}});
    return soup;
}

/// Long thin triangles in all directions through the unit cube.
Soup needles(std::size_t count) {
    Soup soup;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(5, i);
        const Vec3 a{rng.uniform(), rng.uniform(), rng.uniform()};
        const Vec3 b{rng.uniform(), rng.uniform(), rng.uniform()};
        soup.add({a, b, b + Vec3{0.01F, 0.01F, 0.01F} * rng.uniform()});
    }
    return soup;
}

/// A floor of long strips that run at 45 degrees to the axes: every box holds half of the floor.
Soup stripes(std::size_t count) {
    Soup soup;
    const float width = 1.0F / static_cast<float>(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 a = Vec3{1, 0, -1} * (width * static_cast<float>(i));
        const Vec3 step = Vec3{1, 0, -1} * width;
        const Vec3 along{1, 0, 1};
        soup.add({a, a + along, a + step});
        soup.add({a + step, a + along, a + along + step});
    }
    return soup;
}

std::vector<TriangleSet> pathological_triangles() {
    std::vector<TriangleSet> sets;
    for (const BoxSet& set : pathological_sets())
        sets.push_back({set.name, triangles_in(set.boxes)});
    sets.push_back({"needles", needles(2000)});
    sets.push_back({"stripes", stripes(300)});
    for (const Coordinates how :
         {Coordinates::smooth, Coordinates::grid, Coordinates::mixed, Coordinates::wild}) {
        Rng rng(11);
        Soup soup;
        while (soup.corners.size() < 300)
            soup.add(test_support::degenerate_triangle(rng, how, soup));
        sets.push_back({"degenerate", soup});
    }
    return sets;
}

std::vector<Aabb> boxes_of(const Soup& soup) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < soup.corners.size(); ++i)
        boxes.push_back(bounds(soup.view()[to_prim(i)]));
    return boxes;
}

/// Every vertex and edge middle of every triangle is in the box of a leaf that lists the triangle.
void expect_every_point_reachable(const Bvh& tree, const Soup& soup) {
    std::vector<std::vector<Aabb>> parts(soup.corners.size());
    for (const Node& node : tree.nodes)
        if (node.is_leaf())
            for (const PrimId prim : tree.prims_of(node))
                parts[to_index(prim)].push_back(node.box());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const Triangle t = soup.view()[to_prim(i)];
        const Vec3d a = to_double(t.v0);
        const Vec3d b = to_double(t.v1);
        const Vec3d c = to_double(t.v2);
        for (const Vec3d point :
             {a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5, (a + b * 2.0 + c) * 0.25}) {
            bool is_found = false;
            for (const Aabb& box : parts[i])
                is_found = is_found || contains(box, point);
            ASSERT_TRUE(is_found) << "triangle " << i;
        }
    }
}

template <HitMeasure M>
void expect_valid_everywhere(const M& measure) {
    for (const TriangleSet& set : pathological_triangles()) {
        SCOPED_TRACE(set.name);
        for (const double duplication : {0.0, 0.3, 8.0}) {
            const SpatialParams params{.binned = {.max_leaf_size = 2}, .duplication = duplication};
            const Bvh tree = build_spatial(set.soup.view(), measure, params);
            ASSERT_EQ(find_fault(tree, set.soup.corners.size()), std::nullopt);
            const TreeStatistics shape = measure_tree(tree);
            EXPECT_LE(shape.largest_leaf, 2U);
            const auto most = static_cast<std::size_t>(
                static_cast<double>(set.soup.corners.size()) * (1 + duplication)
            );
            EXPECT_LE(shape.references, most);
            if (set.name != "degenerate") expect_every_point_reachable(tree, set.soup);
        }
    }
}

TEST(BuildSpatial, TreeOverNoTrianglesIsEmpty) {
    EXPECT_TRUE(build_spatial({}, SurfaceMeasure{}).is_empty());
}

TEST(BuildSpatial, PathologicalTrianglesGiveValidTreesForSurfaceArea) {
    expect_valid_everywhere(SurfaceMeasure{});
}

TEST(BuildSpatial, PathologicalTrianglesGiveValidTreesForABlindMeasure) {
    expect_valid_everywhere(BlindMeasure{});
}

TEST(BuildSpatial, PathologicalTrianglesGiveValidTreesForAWindow) {
    expect_valid_everywhere(WindowMeasure{});
}

TEST(BuildSpatial, PathologicalTrianglesGiveValidTreesForANarrowedMeasure) {
    expect_valid_everywhere(random_points(50));
}

TEST(BuildSpatial, DepthStaysInBounds) {
    for (const TriangleSet& set : pathological_triangles()) {
        SCOPED_TRACE(set.name);
        for (const int depth : {1, 3, 9, 12}) {
            const SpatialParams params{
                .binned = {.max_leaf_size = 2, .max_depth = depth}, .duplication = 2
            };
            const Bvh tree = build_spatial(set.soup.view(), SurfaceMeasure{}, params);
            ASSERT_EQ(find_fault(tree, set.soup.corners.size()), std::nullopt);
            EXPECT_LE(measure_tree(tree).max_depth, depth);
        }
    }
}

TEST(BuildSpatial, WithoutRoomItIsTheBinnedTree) {
    const Soup soup = needles(3000);
    const Bvh plain = build_binned(boxes_of(soup), SurfaceMeasure{});
    EXPECT_TRUE(same_bytes(build_spatial(soup.view(), SurfaceMeasure{}, {.duplication = 0}), plain)
    );
}

TEST(BuildSpatial, DiagonalStripesCostLessTheMoreTheyMayBeCut) {
    const Soup soup = stripes(500);
    double last = tree_cost(build_binned(boxes_of(soup), SurfaceMeasure{}), SurfaceMeasure{});
    const double plain = last;
    for (const double duplication : {1.0, 3.0, 8.0}) {
        const SpatialParams params{.duplication = duplication};
        const double cost =
            tree_cost(build_spatial(soup.view(), SurfaceMeasure{}, params), SurfaceMeasure{});
        EXPECT_LT(cost, last) << duplication;
        last = cost;
    }
    EXPECT_LT(last, 0.5 * plain);
}

TEST(BuildSpatial, SameBytesForAnyNumberOfThreads) {
    std::vector<TriangleSet> sets = pathological_triangles();
    sets.push_back({"many needles", needles(60'000)});
    for (const TriangleSet& set : sets) {
        SCOPED_TRACE(set.name);
        const Bvh serial = build_spatial(set.soup.view(), SurfaceMeasure{});
        for (const int threads : {2, 3})
            EXPECT_TRUE(same_bytes(
                serial, build_spatial(set.soup.view(), SurfaceMeasure{}, {}, Executor(threads))
            ));
    }
}

TEST(BuildSpatial, SameBytesForEveryCompiler) {
    std::uint64_t hash = 0;
    for (const TriangleSet& set : pathological_triangles()) {
        // Whose random numbers are drawn in an order that compilers choose.
        if (set.name == "degenerate") continue;
        const Bvh tree = build_spatial(set.soup.view(), SurfaceMeasure{}, {.duplication = 2});
        hash = hash_elements(std::span<const Node>(tree.nodes), hash);
        hash = hash_elements(std::span<const PrimId>(tree.prims), hash);
    }
    // Changes with the method, and then for all compilers alike.
    EXPECT_EQ(hex(hash), "b1354c71d4432dd5");
}

TEST(BuildSpatial, RefusesWhatNoTreeCanHoldAndParametersOutOfRange) {
    Soup bad = needles(10);
    bad.vertices[4].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(static_cast<void>(build_spatial(bad.view(), SurfaceMeasure{})), Error);
    const Soup soup = needles(10);
    const auto build = [&](const SpatialParams& params) {
        static_cast<void>(build_spatial(soup.view(), SurfaceMeasure{}, params));
    };
    EXPECT_THROW(build({.binned = {.bin_count = 1}}), Error);
    EXPECT_THROW(build({.spatial_bins = 1}), Error);
    EXPECT_THROW(build({.spatial_bins = 65}), Error);
    EXPECT_THROW(build({.duplication = -0.1}), Error);
    EXPECT_THROW(build({.duplication = 8.1}), Error);
    EXPECT_THROW(build({.least_overlap = -1}), Error);
    EXPECT_NO_THROW(build({.spatial_bins = 64, .duplication = 8, .least_overlap = 0}));
}

} // namespace
} // namespace raywise
