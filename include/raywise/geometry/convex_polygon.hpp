// Convex polygons in the plane: containment, intersection, area, hull. After [Sutherland74],
// [Andrew79].
#pragma once

#include <raywise/geometry/fixed_polygon.hpp>
#include <raywise/geometry/vec.hpp>

#include <span>

namespace raywise {

/// A closed convex polygon, vertices in order, either winding. Fewer than three vertices: the empty
/// set.
using ConvexPolygon = FixedPolygon<Vec2d>;

/// The closed axis-parallel rectangle [lo, hi]. The default is the window of normalized
/// coordinates.
struct Rectangle {
    Vec2d lo{-1, -1};
    Vec2d hi{1, 1};
};

/// The corners counter-clockwise.
[[nodiscard]] ConvexPolygon to_polygon(const Rectangle& rectangle);

/// In square units, >= 0; 0 below three vertices. Coordinates are taken relative to the first
/// vertex, so that a small polygon far from the origin keeps its digits.
[[nodiscard]] double area(const ConvexPolygon& polygon);

/// Whether the point is in the closed polygon. A polygon of no area contains nothing, NaN is in
/// nothing.
[[nodiscard]] bool contains(const ConvexPolygon& polygon, Vec2d point);

/// The common part of polygon and rectangle, at most four vertices more; empty when they share no
/// area beyond a touched edge or corner.
[[nodiscard]] ConvexPolygon intersect(const ConvexPolygon& polygon, const Rectangle& window);

/// The common part, by clipping `a` with each edge of `b`; the sum of the sizes is at most the
/// capacity. Empty when fewer than three vertices remain. O(|a| |b|). [Sutherland74]
[[nodiscard]] ConvexPolygon intersect(const ConvexPolygon& a, const ConvexPolygon& b);

/// The same set found another way: the hull of the vertices of each in the other and of the proper
/// crossings of their edges. Agrees with `intersect` in area to 1e-5 relative; slower; the oracle
/// of its tests. Each polygon has at most 8 vertices.
[[nodiscard]] ConvexPolygon intersect_by_crossings(const ConvexPolygon& a, const ConvexPolygon& b);

/// The convex hull, counter-clockwise, without collinear vertices; empty when the points have no
/// area. At most 64 points (more: an Error), of which at most `capacity` may be extreme.
/// O(n log n). [Andrew79]
[[nodiscard]] ConvexPolygon convex_hull(std::span<const Vec2d> points);

} // namespace raywise
