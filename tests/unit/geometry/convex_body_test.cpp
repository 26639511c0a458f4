#include <raywise/geometry/convex_body.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/sampling.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace raywise {
namespace {

/// By definition: the least and the greatest over the vertices.
Shadow shadow_of(std::span<const Vec3d> vertices, Vec3d axis) {
    Shadow shadow{HUGE_VAL, -HUGE_VAL};
    for (const Vec3d& vertex : vertices) {
        shadow.lo = std::min(shadow.lo, dot(axis, vertex));
        shadow.hi = std::max(shadow.hi, dot(axis, vertex));
    }
    return shadow;
}

template <class Body>
void expect_shadows_of(const Body& body, std::span<const Vec3d> vertices, Rng& rng) {
    for (const Vec3d axis : {sample_sphere(rng), Vec3d{1, 0, 0}, Vec3d{0, -2, 0}, Vec3d{}}) {
        const Shadow expected = shadow_of(vertices, axis);
        EXPECT_NEAR(body.shadow(axis).lo, expected.lo, 1e-14 * 10);
        EXPECT_NEAR(body.shadow(axis).hi, expected.hi, 1e-14 * 10);
    }
    for (const Vec3d& vertex : vertices)
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_LE(std::abs(vertex[axis]), body.reach()[axis] * (1 + 1e-15));
}

template <class Kind>
std::array<Vec3d, 8> vertices_of(const Kind& kind) {
    std::array<Vec3d, 8> vertices;
    for (int i = 0; i < 8; ++i)
        vertices[static_cast<std::size_t>(i)] = vertex(kind, i);
    return vertices;
}

TEST(ConvexBody, ShadowsAreTheExtremesOfTheVertices) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(151, i);
        const Aabb box = testing::random_box(rng, testing::random_point(rng, 1), 1);
        std::array<Vec3d, 8> corners;
        for (int k = 0; k < 8; ++k)
            corners[static_cast<std::size_t>(k)] = to_double(box.vertex(k));
        expect_shadows_of(BoxBody(box), corners, rng);
        const Obb obb = testing::random_obb(rng, 1, 1);
        expect_shadows_of(BoxBody(obb), vertices_of(obb), rng);
        const Frustum frustum = testing::random_frustum(rng, 1);
        expect_shadows_of(FrustumBody(frustum), vertices_of(frustum), rng);
        const Triangle triangle = testing::random_triangle(rng, {0, 0, 0}, 1);
        const std::array<Vec3d, 3> ends{
            to_double(triangle.v0), to_double(triangle.v1), to_double(triangle.v2)
        };
        expect_shadows_of(TriangleBody(triangle), ends, rng);
    }
}

// Section 2.6 of the method: the extreme vertices of a box by the signs of the axis.
TEST(ConvexBody, TheExtremeVerticesOfABoxFollowTheSignsOfTheAxis) {
    const Aabb box{{1, 2, 3}, {4, 6, 8}};
    for (int i = 0; i < 8; ++i) {
        const Vec3d axis{
            (i & 4) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 2.0 : -2.0, (i & 1) != 0 ? 3.0 : -3.0
        };
        const Shadow shadow = BoxBody(box).shadow(axis);
        EXPECT_EQ(shadow.hi, dot(axis, to_double(box.vertex(i))));
        EXPECT_EQ(shadow.lo, dot(axis, to_double(box.vertex(7 - i))));
    }
}

TEST(ConvexBody, CandidateAxesAreAsManyAsTheMethodCounts) {
    const BoxBody box(Aabb{{0, 0, 0}, {1, 1, 1}});
    const FrustumBody frustum(Frustum{});
    const TriangleBody triangle(Triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const auto axes = [](const auto& a, const auto& b) {
        return a.normals().size() + b.normals().size() + a.edges().size() * b.edges().size();
    };
    EXPECT_EQ(axes(box, box), 15U);
    EXPECT_EQ(axes(box, frustum), 26U);
    EXPECT_EQ(axes(box, triangle), 13U);
    EXPECT_EQ(axes(frustum, triangle), 24U);
}

TEST(ConvexBody, NormalsAreAcrossTheFacesAndEdgesAlongThem) {
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(152, i);
        const Frustum frustum = testing::random_frustum(rng, 1);
        const FrustumBody body(frustum);
        for (const Vec3d& normal : body.normals()) {
            // A face holds two edge directions at least.
            int along = 0;
            for (const Vec3d& edge : body.edges())
                along += std::abs(dot(normal, edge)) < 1e-14 * 10 ? 1 : 0;
            EXPECT_GE(along, 2);
        }
    }
    EXPECT_TRUE(TriangleBody(Triangle{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}).normals().empty());
    EXPECT_TRUE(TriangleBody(Triangle{}).normals().empty());
}

} // namespace
} // namespace raywise
