#include <raywise/geometry/convex_polygon.hpp>

#include "support/random_geometry.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <vector>

namespace raywise {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

ConvexPolygon polygon_of(std::initializer_list<Vec2d> vertices) {
    ConvexPolygon polygon;
    for (const Vec2d vertex : vertices)
        polygon.push_back(vertex);
    return polygon;
}

ConvexPolygon reversed(const ConvexPolygon& polygon) {
    ConvexPolygon result;
    for (std::size_t i = polygon.size(); i-- > 0;)
        result.push_back(polygon[i]);
    return result;
}

/// The hull of a few random points around `center`.
ConvexPolygon random_polygon(Rng& rng, Vec2d center, double size) {
    std::array<Vec2d, 7> points;
    for (Vec2d& point : points) {
        const double x = rng.uniform(-size, size);
        point = center + Vec2d{x, rng.uniform(-size, size)};
    }
    return convex_hull(points);
}

const ConvexPolygon square = to_polygon({{0, 0}, {1, 1}});
const ConvexPolygon far_square = to_polygon({{1e8, 1e8}, {1e8 + 1, 1e8 + 1}});

TEST(ConvexPolygon, BelowThreeVerticesThereIsNoAreaNoPointAndNoIntersection) {
    const ConvexPolygon segment = polygon_of({{0, 0}, {1, 1}});
    for (const ConvexPolygon& nothing : {ConvexPolygon{}, polygon_of({{0, 0}}), segment}) {
        EXPECT_EQ(area(nothing), 0);
        EXPECT_FALSE(contains(nothing, {0, 0}));
        EXPECT_TRUE(intersect(nothing, Rectangle{}).empty());
        EXPECT_TRUE(intersect(nothing, square).empty());
        EXPECT_TRUE(intersect(square, nothing).empty());
        EXPECT_TRUE(intersect_by_crossings(nothing, square).empty());
    }
}

TEST(ConvexPolygon, WithoutAreaItContainsNothing) {
    EXPECT_FALSE(contains(polygon_of({{0, 0}, {1, 1}, {2, 2}}), {1, 1}));
    EXPECT_TRUE(intersect(square, polygon_of({{0, 0}, {1, 1}, {2, 2}})).empty());
}

TEST(ConvexPolygon, ContainsItsBoundaryInEitherWinding) {
    for (const ConvexPolygon& polygon : {square, reversed(square)}) {
        for (const Vec2d p : square)
            EXPECT_TRUE(contains(polygon, p));
        EXPECT_TRUE(contains(polygon, {0.5, 0}));
        EXPECT_TRUE(contains(polygon, {0.5, 0.5}));
        EXPECT_FALSE(contains(polygon, {0.5, -1e-15}));
        EXPECT_FALSE(contains(polygon, {nan_value, 0.5}));
        EXPECT_FALSE(contains(polygon, {0.5, nan_value}));
    }
    // Thesis: a first cross product of exactly 0 rejected everything.
    EXPECT_TRUE(contains(polygon_of({{0, 0}, {0, 0}, {1, 0}, {1, 1}}), {0.5, 0.25}));
}

TEST(ConvexPolygon, ASmallAreaFarFromTheOriginKeepsItsDigits) {
    EXPECT_EQ(area(far_square), 1);
    EXPECT_EQ(area(reversed(far_square)), 1);
    // What relative coordinates are for: the plain sum loses everything here.
    double plain = 0;
    for (std::size_t i = 0; i < 4; ++i)
        plain += cross(far_square[i], far_square.after(i));
    EXPECT_GT(std::abs(plain / 2 - 1), 0.1);
}

// Thesis: crossings were accepted up to 0.01 outside the segments.
TEST(ConvexPolygon, SmallSquaresBesideEachOtherDoNotOverlap) {
    const ConvexPolygon a = to_polygon({{0, 0}, {0.03, 0.03}});
    const ConvexPolygon b = to_polygon({{0.039, 0}, {0.069, 0.03}});
    EXPECT_EQ(area(intersect(a, b)), 0);
    EXPECT_EQ(area(intersect_by_crossings(a, b)), 0);
    EXPECT_EQ(area(intersect(a, Rectangle{{0.039, 0}, {0.069, 0.03}})), 0);
}

TEST(ConvexPolygon, IntersectionWithItselfIsItselfAndWithATouchingOneHasNoArea) {
    EXPECT_EQ(area(intersect(square, square)), 1);
    EXPECT_EQ(area(intersect_by_crossings(square, square)), 1);
    EXPECT_EQ(area(intersect(square, reversed(square))), 1);
    EXPECT_EQ(area(intersect(square, Rectangle{{1, 0}, {2, 1}})), 0);
    EXPECT_EQ(area(intersect_by_crossings(square, to_polygon({{1, 0}, {2, 1}}))), 0);
}

TEST(ConvexPolygon, ClippingCrossingsAndTheRectangleFormAgreeInArea) {
    int overlapping = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        Rng rng(61, i);
        const double scale = std::pow(10, rng.uniform(-6, 6));
        const Vec2d offset{rng.uniform(-scale, scale), rng.uniform(-scale, scale)};
        const ConvexPolygon a = random_polygon(rng, offset, scale);
        const ConvexPolygon b = random_polygon(rng, {0, 0}, scale);
        const double by_clipping = area(intersect(a, b));
        const double tolerance = 1e-5 * by_clipping + 1e-12 * scale * scale;
        EXPECT_NEAR(area(intersect(b, a)), by_clipping, tolerance);
        EXPECT_NEAR(area(intersect(reversed(a), reversed(b))), by_clipping, tolerance);
        EXPECT_NEAR(area(intersect_by_crossings(a, b)), by_clipping, tolerance);
        EXPECT_LE(by_clipping, std::min(area(a), area(b)) + tolerance);
        overlapping += by_clipping > 0 ? 1 : 0;

        const Rectangle window{{-scale / 3, -scale / 2}, {scale / 2, scale / 3}};
        const ConvexPolygon cut = intersect(a, window);
        EXPECT_LE(cut.size(), a.size() + 4);
        EXPECT_NEAR(area(cut), area(intersect(a, to_polygon(window))), tolerance);
        EXPECT_NEAR(
            area(cut),
            area(intersect_by_crossings(a, to_polygon(window))),
            1e-5 * area(cut) + tolerance
        );
    }
    EXPECT_GT(overlapping, 10000);
}

TEST(ConvexPolygon, AreaAndIntersectionAgreeWithCountedPoints) {
    constexpr int samples = 20000;
    for (std::uint64_t i = 0; i < 20; ++i) {
        Rng rng(62, i);
        const ConvexPolygon a = random_polygon(rng, {0, 0}, 1);
        const ConvexPolygon b = random_polygon(rng, {0.2, 0.1}, 1);
        int in_a = 0;
        int in_both = 0;
        for (int k = 0; k < samples; ++k) {
            const double x = rng.uniform(-2, 2);
            const Vec2d p{x, rng.uniform(-2, 2)};
            in_a += contains(a, p) ? 1 : 0;
            in_both += contains(a, p) && contains(b, p) ? 1 : 0;
        }
        // A share below 1/4 of 16 square units: five standard deviations.
        const double spread = 5 * 16 * std::sqrt(0.25 * 0.75 / samples);
        EXPECT_NEAR(16.0 * in_a / samples, area(a), spread);
        EXPECT_NEAR(16.0 * in_both / samples, area(intersect(a, b)), spread);
    }
}

TEST(ConvexHull, OfNothingOnePointAndALineIsEmpty) {
    EXPECT_TRUE(convex_hull({}).empty());
    const std::vector<Vec2d> same(5, Vec2d{1, 2});
    EXPECT_TRUE(convex_hull(same).empty());
    const std::vector<Vec2d> line{{0, 0}, {3, 3}, {1, 1}, {2, 2}};
    EXPECT_TRUE(convex_hull(line).empty());
    const std::vector<Vec2d> too_many(65);
    EXPECT_THROW((void)convex_hull(too_many), Error);
}

TEST(ConvexHull, DropsInnerCollinearAndRepeatedPoints) {
    const std::vector<Vec2d> points{
        {0, 0}, {1, 0}, {0.5, 0}, {1, 1}, {0, 1}, {0.5, 0.5}, {0, 0}, {1, 0.25}
    };
    const ConvexPolygon hull = convex_hull(points);
    EXPECT_EQ(hull.size(), 4U);
    EXPECT_EQ(area(hull), 1);
}

TEST(ConvexHull, HoldsItsPointsAndItsVerticesAreAmongThem) {
    for (std::uint64_t i = 0; i < 3000; ++i) {
        Rng rng(63, i);
        std::array<Vec2d, 12> points;
        for (Vec2d& point : points) {
            const double x = std::floor(rng.uniform(-4, 5)); // small integers: exact, degenerate
            point = {x, std::floor(rng.uniform(-4, 5))};
        }
        const ConvexPolygon hull = convex_hull(points);
        ASSERT_GE(hull.size(), 3U);
        for (const Vec2d point : points)
            EXPECT_TRUE(contains(hull, point));
        for (std::size_t k = 0; k < hull.size(); ++k) {
            EXPECT_NE(std::find(points.begin(), points.end(), hull[k]), points.end());
            const Vec2d next = hull.after(k);
            const Vec2d second = hull.after(k + 1 == hull.size() ? 0 : k + 1);
            EXPECT_GT(cross(next - hull[k], second - next), 0); // strictly left turns
        }
    }
}

} // namespace
} // namespace raywise
