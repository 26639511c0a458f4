#include <raywise/geometry/convex_polygon.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/fixed_polygon.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace raywise {

namespace {

/// Twice the signed area, positive when counter-clockwise, relative to the first vertex.
double twice_signed_area(const ConvexPolygon& polygon) {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        sum += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    return sum;
}

ConvexPolygon or_nothing(const ConvexPolygon& polygon) {
    return polygon.size() < 3 ? ConvexPolygon{} : polygon;
}

/// Where the segments (a, b) and (c, d) cross properly: each has its ends strictly on both sides of
/// the other. Then `add(point)` is called.
template <class Add>
void cross_properly(Vec2d a, Vec2d b, Vec2d c, Vec2d d, const Add& add) {
    const double c_side = cross(b - a, c - a);
    const double d_side = cross(b - a, d - a);
    const double a_side = cross(d - c, a - c);
    const double b_side = cross(d - c, b - c);
    const bool splits_cd = (c_side < 0 && d_side > 0) || (c_side > 0 && d_side < 0);
    const bool splits_ab = (a_side < 0 && b_side > 0) || (a_side > 0 && b_side < 0);
    if (splits_cd && splits_ab) add(c + (d - c) * (c_side / (c_side - d_side)));
}

} // namespace

ConvexPolygon to_polygon(const Rectangle& rectangle) {
    ConvexPolygon polygon;
    polygon.push_back(rectangle.lo);
    polygon.push_back({rectangle.hi.x, rectangle.lo.y});
    polygon.push_back(rectangle.hi);
    polygon.push_back({rectangle.lo.x, rectangle.hi.y});
    return polygon;
}

double area(const ConvexPolygon& polygon) {
    return std::abs(twice_signed_area(polygon)) / 2;
}

bool contains(const ConvexPolygon& polygon, Vec2d point) {
    const double winding = twice_signed_area(polygon);
    if (!(std::abs(winding) > 0)) return false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const double side = cross(polygon.after(i) - polygon[i], point - polygon[i]);
        if (!(winding > 0 ? side >= 0 : side <= 0)) return false;
    }
    return true;
}

ConvexPolygon intersect(const ConvexPolygon& polygon, const Rectangle& window) {
    ConvexPolygon part = clipped(polygon, [&](Vec2d p) { return p.x - window.lo.x; });
    part = clipped(part, [&](Vec2d p) { return window.hi.x - p.x; });
    part = clipped(part, [&](Vec2d p) { return p.y - window.lo.y; });
    part = clipped(part, [&](Vec2d p) { return window.hi.y - p.y; });
    return or_nothing(part);
}

ConvexPolygon intersect(const ConvexPolygon& a, const ConvexPolygon& b) {
    const double winding = twice_signed_area(b);
    if (!(std::abs(winding) > 0)) return {};
    const double inward = winding > 0 ? 1 : -1;
    ConvexPolygon part = a;
    for (std::size_t i = 0; i < b.size() && !part.empty(); ++i) {
        const Vec2d edge = b.after(i) - b[i];
        part = clipped(part, [&](Vec2d p) { return inward * cross(edge, p - b[i]); });
    }
    return or_nothing(part);
}

ConvexPolygon intersect_by_crossings(const ConvexPolygon& a, const ConvexPolygon& b) {
    // Two convex polygons have at most 2 min(|a|, |b|) proper crossings.
    std::array<Vec2d, 64> points;
    std::size_t count = 0;
    const auto add = [&](Vec2d p) { points[count++] = p; };
    for (const Vec2d p : a)
        if (contains(b, p)) add(p);
    for (const Vec2d p : b)
        if (contains(a, p)) add(p);
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j)
            cross_properly(a[i], a.after(i), b[j], b.after(j), add);
    return convex_hull(std::span(points.data(), count));
}

ConvexPolygon convex_hull(std::span<const Vec2d> points) {
    constexpr std::size_t most = 64;
    if (points.size() > most) throw Error("a hull takes at most 64 points");
    std::array<Vec2d, most> copies;
    std::copy(points.begin(), points.end(), copies.begin());
    const std::span<Vec2d> sorted = std::span(copies).first(points.size());
    std::sort(sorted.begin(), sorted.end(), [](Vec2d p, Vec2d q) {
        return p.x < q.x || (p.x == q.x && p.y < q.y);
    });

    // The lower chain from left to right, then the upper one back; right turns are dropped.
    std::array<Vec2d, most + 1> chain;
    std::size_t size = 0;
    const auto extend = [&](Vec2d p, std::size_t kept) {
        while (size > kept && !(cross(chain[size - 1] - chain[size - 2], p - chain[size - 1]) > 0))
            --size;
        chain[size++] = p;
    };
    for (std::size_t i = 0; i < points.size(); ++i)
        extend(sorted[i], 1);
    const std::size_t lower = size;
    for (std::size_t i = points.size(); i-- > 1;)
        extend(sorted[i - 1], lower);
    if (size < 4) return {}; // the first point stands at both ends
    if (size - 1 > ConvexPolygon::capacity) throw Error("a hull has at most 16 vertices");
    ConvexPolygon hull;
    for (std::size_t i = 0; i + 1 < size; ++i)
        hull.push_back(chain[i]);
    return hull;
}

} // namespace raywise
