#include <raywise/geometry/silhouette.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/frame.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace raywise {
namespace {

/// The four corners of a box face, counter-clockwise seen from outside, found from its geometry.
std::array<int, 4> outward_face(int axis, int side) {
    const std::array<int, 3> bits{4, 2, 1};
    const int u = bits[static_cast<std::size_t>((axis + 1) % 3)];
    const int v = bits[static_cast<std::size_t>((axis + 2) % 3)];
    const int base = side > 0 ? bits[static_cast<std::size_t>(axis)] : 0;
    if (side > 0) return {base, base + u, base + u + v, base + v};
    return {base, base + v, base + u + v, base + u};
}

/// The rule: directed edges of the visible faces whose reverse is absent, chained.
std::vector<int> outline_by_cancellation(const std::array<int, 3>& code) {
    std::vector<std::pair<int, int>> edges;
    for (int axis = 0; axis < 3; ++axis) {
        const int side = code[static_cast<std::size_t>(axis)];
        if (side == 0) continue;
        const std::array<int, 4> face = outward_face(axis, side);
        for (std::size_t i = 0; i < 4; ++i)
            edges.emplace_back(face[i], face[(i + 1) % 4]);
    }
    std::map<int, int> next;
    for (const auto& [from, to] : edges)
        if (std::find(edges.begin(), edges.end(), std::pair(to, from)) == edges.end())
            next[from] = to;
    std::vector<int> cycle;
    if (next.empty()) return cycle;
    const int start = next.begin()->first;
    for (int at = start; cycle.empty() || at != start; at = next.at(at))
        cycle.push_back(at);
    return cycle;
}

std::vector<int> table(ViewCode code) {
    const Silhouette& cycle = silhouette(code);
    return {cycle.vertices.begin(), cycle.vertices.begin() + static_cast<int>(cycle.size)};
}

TEST(Silhouette, AllTwentySevenViewsFollowTheCancellationOfSharedEdges) {
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                const std::vector<int> rule = outline_by_cancellation({x, y, z});
                std::vector<int> cycle = table(to_view_code(x, y, z));
                ASSERT_EQ(cycle.size(), rule.size());
                if (rule.empty()) continue;
                const auto first = std::find(cycle.begin(), cycle.end(), rule.front());
                ASSERT_NE(first, cycle.end());
                std::rotate(cycle.begin(), first, cycle.end());
                EXPECT_EQ(cycle, rule) << x << y << z;
            }
}

TEST(Silhouette, FromInsideAndFromAFacePlaneTheCodesAreThoseOfTheClosedSlabs) {
    const Aabb box{{0, 0, 0}, {1, 2, 3}};
    EXPECT_EQ(view_from(box, {0.5, 1, 1}), view_inside);
    EXPECT_EQ(view_from(box, {1, 2, 3}), view_inside); // a corner of the closed box
    EXPECT_EQ(view_from(box, {-1, 2, 4}), to_view_code(-1, 0, 1));
    EXPECT_EQ(silhouette(view_inside).size, 0U);
}

// Thesis: |d| <= 0.01 was zero, so oblique rays saw one face less.
TEST(Silhouette, ParallelRaysTestZeroExactly) {
    EXPECT_EQ(view_along({0, 0.0, -1}), to_view_code(0, 0, 1));
    EXPECT_EQ(view_along({-0.0, 1e-300, 1}), to_view_code(0, -1, -1));
    EXPECT_EQ(view_along({0.005, 0, -1}), to_view_code(-1, 0, 1));
}

TEST(Silhouette, TwentyThousandRandomViewsAreTheHullsOfTheProjectedVertices) {
    int compared = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        Rng rng(31, i);
        const Aabb box = testing::random_box(rng, {0, 0, 0}, 1.0);
        const Vec3d eye = sample_sphere(rng) * rng.uniform(0.2, 6);
        const ViewCode code = view_from(box, eye);
        if (code == view_inside) continue;
        const Frame frame = frame_along(-eye);
        std::array<Vec2d, 8> shadow;
        bool in_front = true;
        for (int k = 0; k < 8; ++k) {
            const Vec3d at = to_frame(frame, to_double(box.vertex(k)) - eye);
            in_front = in_front && at.z > 0.01;
            shadow[static_cast<std::size_t>(k)] = {at.x / at.z, at.y / at.z};
        }
        if (!in_front) continue;
        ++compared;
        const Silhouette& cycle = silhouette(code);
        ConvexPolygon outline;
        double twice_signed = 0;
        for (std::size_t k = 0; k < cycle.size; ++k)
            outline.push_back(shadow[cycle.vertices[k]]);
        for (std::size_t k = 0; k < cycle.size; ++k)
            twice_signed += cross(outline[k], outline.after(k));
        const double whole = area(convex_hull(shadow));
        EXPECT_NEAR(area(outline), whole, 1e-12 * (1 + whole));
        // Counter-clockwise to the viewer is clockwise in (right, up), whose third axis points
        // away.
        EXPECT_LE(twice_signed, 1e-12);
    }
    EXPECT_GT(compared, 10000);
}

} // namespace
} // namespace raywise
