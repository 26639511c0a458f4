#include <raywise/geometry/separating_axis.hpp>

#include "support/exact_polytope.hpp"
#include "support/random_geometry.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_body.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <numbers>

namespace raywise {
namespace {

using testing::random_box;
using testing::random_frustum;
using testing::random_obb;
using testing::random_point;
using testing::random_triangle;

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
const Frame world;

TEST(SeparatingAxis, NothingOverlapsTheEmptyBoxOrATriangleWithNaN) {
    const Obb obb{{0, 0, 0}, world, {1, 1, 1}};
    const Frustum frustum;
    EXPECT_FALSE(overlaps(obb, Aabb{}));
    EXPECT_FALSE(overlaps(frustum, Aabb{}));
    const Triangle whole{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    EXPECT_TRUE(overlaps(obb, whole));
    EXPECT_FALSE(overlaps(Aabb{}, whole));
    for (int axis = 0; axis < 3; ++axis) {
        Triangle broken = whole;
        broken.v1[axis] = nan_value;
        EXPECT_FALSE(overlaps(obb, broken));
        EXPECT_FALSE(overlaps(frustum, broken));
        EXPECT_FALSE(overlaps(Aabb{{-9, -9, -9}, {9, 9, 9}}, broken));
    }
}

TEST(SeparatingAxis, TouchingCounts) {
    const Obb obb{{0, 0, 0}, world, {1, 1, 1}};
    EXPECT_TRUE(overlaps(obb, Aabb{{1, 1, 1}, {2, 2, 2}})); // in a corner
    EXPECT_FALSE(overlaps(obb, Aabb{{1.000001F, 1, 1}, {2, 2, 2}}));
    const Frustum pyramid{{0, 0, 0}, world, 1, 1, 0, 1};
    EXPECT_TRUE(overlaps(pyramid, Aabb{{-1, -1, -1}, {0, 0, 0}})); // in the apex
    EXPECT_FALSE(overlaps(pyramid, Aabb{{-1, -1, -1}, {0, 0, -1e-6F}}));
    EXPECT_TRUE(overlaps(pyramid, Triangle{{1, 1, 1}, {2, 1, 1}, {2, 2, 3}}));
}

TEST(SeparatingAxis, PointsSegmentsAndFlatBoxesAreBodies) {
    const Obb obb{{0, 0, 0}, frame_along({1, 1, 0}), {1, 1, 1}};
    const auto point = [](float x, float y, float z) {
        return Triangle{{x, y, z}, {x, y, z}, {x, y, z}};
    };
    EXPECT_TRUE(overlaps(obb, point(0.9F, 0.5F, 0)));
    EXPECT_FALSE(overlaps(obb, point(0.9F, 0.9F, 0))); // in the enclosing box only
    const Triangle segment{{-2, 1.5F, 0}, {1.5F, -2, 0}, {1.5F, -2, 0}};
    EXPECT_TRUE(overlaps(obb, segment));
    const Triangle beside{{0.5F, 1, 0}, {1, 0.5F, 0}, {1, 0.5F, 0}};
    EXPECT_FALSE(overlaps(obb, beside));
    const Obb flat{{0, 0, 0}, frame_along({1, 1, 0}), {1, 1, 0}};
    EXPECT_TRUE(overlaps(flat, Aabb{{0, 0, 0}, {1, 1, 1}}));
    EXPECT_FALSE(overlaps(flat, Aabb{{0.01F, 0.01F, -1}, {1, 1, 1}}));
}

// Thesis: a zero cross product was normalized, and NaN picked the answer.
TEST(SeparatingAxis, ParallelEdgesDecideNothing) {
    const Obb aligned{{0, 0, 0}, world, {1, 1, 1}};
    const Obb nearly{{0, 0, 0}, frame_along({1e-9, 1e-9, 1}), {1, 1, 1}};
    for (const Obb& obb : {aligned, nearly}) {
        EXPECT_TRUE(overlaps(obb, Aabb{{0.5F, 0.5F, 0.5F}, {3, 3, 3}}));
        EXPECT_TRUE(overlaps(obb, Triangle{{0, 0, -5}, {0, 0, 5}, {0, 5, 0}}));
        EXPECT_FALSE(overlaps(obb, Aabb{{1.1F, -3, -3}, {3, 3, 3}}));
    }
}

// Thesis: an oriented box within 8.1 degrees of the axes was answered by its enclosing box.
TEST(SeparatingAxis, ASlightlyTurnedBoxIsNotItsEnclosingBox) {
    constexpr double five_degrees = 5 * std::numbers::pi / 180;
    const Obb turned{{0, 0, 0}, frame_along({0, 0, 1}, five_degrees), {10, 10, 10}};
    // The corner of the enclosing box: 10 (cos 5 + sin 5) = 10.83.
    const Aabb in_the_corner{{10.7F, 10.7F, -1}, {10.8F, 10.8F, 1}};
    EXPECT_TRUE(overlaps(bounds(turned), in_the_corner));
    EXPECT_FALSE(overlaps(turned, in_the_corner));
}

template <ConvexBody A, ConvexBody B>
struct Tally {
    int overlapping = 0;
    int missed_by_faces = 0; ///< disjoint, but no face normal says so

    void add(const A& a, const B& b, bool exact) {
        ASSERT_EQ(overlaps(a, b), exact);
        overlapping += exact ? 1 : 0;
        missed_by_faces += !exact && !separated_by_face(a, b) ? 1 : 0;
    }

    /// Both answers occurred, and without the cross products some would have been wrong.
    void expect_telling(int pairs) const {
        EXPECT_GT(overlapping, pairs / 10);
        EXPECT_LT(overlapping, pairs * 9 / 10);
        EXPECT_GT(missed_by_faces, 0);
    }
};

constexpr int pairs = 1500;

TEST(SeparatingAxis, OrientedBoxAndBoxAgreeWithExactPolytopes) {
    Tally<BoxBody, BoxBody> tally;
    for (std::uint64_t i = 0; i < pairs; ++i) {
        Rng rng(11, i);
        const Obb obb = random_obb(rng, 0.9, 1.0);
        const Aabb box = random_box(rng, random_point(rng, 0.9), 0.8);
        tally.add(
            BoxBody(box), BoxBody(obb), overlap(oracle::polytope(obb), oracle::polytope(box))
        );
        EXPECT_EQ(overlaps(obb, box), overlaps(BoxBody(box), BoxBody(obb)));
    }
    tally.expect_telling(pairs);
}

TEST(SeparatingAxis, FrustumAndBoxAgreeWithExactPolytopes) {
    Tally<BoxBody, FrustumBody> tally;
    for (std::uint64_t i = 0; i < pairs; ++i) {
        Rng rng(12, i);
        const Frustum frustum = random_frustum(rng, 1.0);
        const Aabb box = random_box(rng, random_point(rng, 1.0), 0.6);
        tally.add(
            BoxBody(box),
            FrustumBody(frustum),
            overlap(oracle::polytope(frustum), oracle::polytope(box))
        );
        EXPECT_EQ(overlaps(frustum, box), overlaps(BoxBody(box), FrustumBody(frustum)));
    }
    tally.expect_telling(pairs);
}

TEST(SeparatingAxis, TriangleAndBoxAgreeWithExactPolytopes) {
    Tally<BoxBody, TriangleBody> tally;
    for (std::uint64_t i = 0; i < pairs; ++i) {
        Rng rng(13, i);
        const Aabb box = random_box(rng, {0, 0, 0}, 1.0);
        const Triangle triangle = random_triangle(rng, random_point(rng, 0.8), 1.0);
        const bool exact = overlap(oracle::polytope(triangle), oracle::polytope(box));
        tally.add(BoxBody(box), TriangleBody(triangle), exact);
        EXPECT_EQ(overlaps(box, triangle), exact);
    }
    tally.expect_telling(pairs);
}

TEST(SeparatingAxis, TriangleAndOrientedBoxAgreeWithExactPolytopes) {
    Tally<BoxBody, TriangleBody> tally;
    for (std::uint64_t i = 0; i < pairs; ++i) {
        Rng rng(14, i);
        const Obb obb = random_obb(rng, 0.5, 1.0);
        const Triangle triangle = random_triangle(rng, random_point(rng, 0.6), 1.0);
        const bool exact = overlap(oracle::polytope(triangle), oracle::polytope(obb));
        tally.add(BoxBody(obb), TriangleBody(triangle), exact);
        EXPECT_EQ(overlaps(obb, triangle), exact);
    }
    tally.expect_telling(pairs);
}

TEST(SeparatingAxis, TriangleAndFrustumAgreeWithExactPolytopes) {
    Tally<FrustumBody, TriangleBody> tally;
    int without_vertex_inside = 0;
    for (std::uint64_t i = 0; i < pairs; ++i) {
        Rng rng(15, i);
        const Frustum frustum = random_frustum(rng, 0.7);
        const Triangle triangle = random_triangle(rng, random_point(rng, 0.7), 1.2);
        const bool exact = overlap(oracle::polytope(triangle), oracle::polytope(frustum));
        tally.add(FrustumBody(frustum), TriangleBody(triangle), exact);
        EXPECT_EQ(overlaps(frustum, triangle), exact);
        const bool vertex_inside = contains(frustum, to_double(triangle.v0)) ||
                                   contains(frustum, to_double(triangle.v1)) ||
                                   contains(frustum, to_double(triangle.v2));
        without_vertex_inside += exact && !vertex_inside ? 1 : 0;
    }
    tally.expect_telling(pairs);
    // Why membership by vertices is not acceptable.
    EXPECT_GT(without_vertex_inside, tally.overlapping / 3);
}

TEST(SeparatingAxis, TheAnswerDoesNotDependOnTheScale) {
    for (const double scale : {1e-12, 1e12}) {
        for (std::uint64_t i = 0; i < 500; ++i) {
            Rng rng(16, i);
            Frustum frustum = random_frustum(rng, 1.0);
            const Aabb box = random_box(rng, random_point(rng, 1.0), 0.6);
            const auto factor = static_cast<float>(scale);
            const bool before = overlaps(frustum, box);
            frustum.eye = frustum.eye * scale;
            frustum.near *= scale;
            frustum.far *= scale;
            EXPECT_EQ(overlaps(frustum, Aabb{box.lo * factor, box.hi * factor}), before);
        }
    }
}

// A point of both bodies is never separated from either by rounding, far from the origin too.
TEST(SeparatingAxis, ATriangleWithAVertexThatContainsAcceptsOverlaps) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
        Rng rng(17, i);
        const Vec3d shift = random_point(rng, i % 2 == 0 ? 0.0 : 1e6);
        Obb obb = random_obb(rng, 1, 2);
        obb.center = obb.center + shift;
        Vec3 corner = to_float(vertex(obb, static_cast<int>(i % 8)));
        if (!contains(obb, to_double(corner))) continue;
        const Triangle point{corner, corner, corner};
        EXPECT_TRUE(overlaps(obb, point));
        EXPECT_TRUE(overlaps(obb, Aabb{corner, corner}));
    }
}

} // namespace
} // namespace raywise
