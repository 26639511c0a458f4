#include <raywise/build/cut_triangle.hpp>

#include "support/soup.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise {
namespace {

using test_support::Coordinates;
using test_support::Soup;

Aabb box_of(const PrimBox& part) {
    return {to_vec(part.lo), to_vec(part.hi)};
}

PrimBox whole(const Triangle& triangle) {
    const Aabb box = bounds(triangle);
    return {Quad{box.lo.x, box.lo.y, box.lo.z, 7}, Quad{box.hi.x, box.hi.y, box.hi.z, 1}};
}

/// Points with weights of 8 binary digits: exact in double for coordinates of 24 digits on one
/// scale.
std::vector<Vec3d> points_on(const Triangle& triangle, Rng& rng) {
    std::vector<Vec3d> points;
    for (int i = 0; i < 64; ++i) {
        const auto u = static_cast<double>(rng.below(257));
        const double v = rng.below(3) == 0 ? 0 : static_cast<double>(rng.below(257));
        if (u + v > 256) continue;
        const double w = 256 - u - v;
        points.push_back(
            (to_double(triangle.v0) * w + to_double(triangle.v1) * u + to_double(triangle.v2) * v) *
            (1.0 / 256)
        );
    }
    return points;
}

TEST(CutReference, HalvesOfARightTriangleAreTight) {
    const Soup soup = [] {
        Soup s;
        s.add({{0, 0, 2}, {4, 0, 2}, {0, 4, 2}});
        return s;
    }();
    const CutReference cut =
        cut_reference(whole(soup.view()[PrimId{0}]), corners_of(soup.view(), PrimId{0}), 0, 1);
    EXPECT_EQ(box_of(cut.left), (Aabb{{0, 0, 2}, {1, 4, 2}}));
    EXPECT_EQ(box_of(cut.right).lo, (Vec3{1, 0, 2}));
    EXPECT_EQ(box_of(cut.right).hi.x, 4);
    EXPECT_NEAR(box_of(cut.right).hi.y, 3, 1e-5);
    EXPECT_EQ(box_of(cut.right).hi.z, 2);
    EXPECT_EQ(cut.left.id(), cut.right.id());
    EXPECT_EQ(cut.left.id(), PrimId{7 + (1U << 16U)});
}

TEST(CutReference, PartThatTheTriangleDoesNotReachIsEmpty) {
    // In the corner of its box that a triangle leaves free.
    const Triangle triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    Soup soup;
    soup.add(triangle);
    PrimBox corner = whole(triangle);
    corner.lo[0] = 1;
    corner.lo[1] = 2;
    const CutReference cut = cut_reference(corner, corners_of(soup.view(), PrimId{0}), 0, 3);
    EXPECT_FALSE(CutReference::is_empty(cut.left));
    EXPECT_TRUE(CutReference::is_empty(cut.right));
}

TEST(CutReference, NoPointOfATriangleIsLostByRepeatedCuts) {
    for (const Coordinates how : {Coordinates::smooth, Coordinates::grid}) {
        for (std::uint64_t seed = 0; seed < 2000; ++seed) {
            Rng rng(seed);
            const Soup soup = test_support::random_soup(rng, 1, how);
            const Triangle triangle = soup.view()[PrimId{0}];
            const Corners corners = corners_of(soup.view(), PrimId{0});
            const std::vector<Vec3d> points = points_on(triangle, rng);
            std::vector<PrimBox> parts{whole(triangle)};
            for (int step = 0; step < 6; ++step) {
                const auto at = static_cast<std::size_t>(rng.below(parts.size()));
                const PrimBox part = parts[at];
                const auto axis = static_cast<int>(rng.below(3));
                // Through a vertex now and then.
                const auto vertex = static_cast<std::size_t>(rng.below(3));
                const float x = rng.below(4) == 0 ? corners[vertex][axis]
                                                  : part.lo[axis] + (part.hi[axis] - part.lo[axis]
                                                                    ) * rng.uniform();
                if (!(x >= part.lo[axis] && x <= part.hi[axis])) continue;
                const CutReference cut = cut_reference(part, corners, axis, x);
                for (const Vec3d point : points) {
                    if (!contains(box_of(part), point)) continue;
                    const bool is_kept =
                        contains(box_of(cut.left), point) || contains(box_of(cut.right), point);
                    ASSERT_TRUE(is_kept) << "seed " << seed << ", step " << step;
                }
                parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(at));
                if (!CutReference::is_empty(cut.left)) parts.push_back(cut.left);
                if (!CutReference::is_empty(cut.right)) parts.push_back(cut.right);
                if (parts.empty()) break;
            }
        }
    }
}

} // namespace
} // namespace raywise
