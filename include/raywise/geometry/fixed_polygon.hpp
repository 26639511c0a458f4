// Vertices of a small convex polygon in order, without allocation, and its clip by a half-space.
// After [Sutherland74].
#pragma once

#include <array>
#include <cassert>
#include <cstddef>

namespace raywise {

/// Up to `capacity` vertices in order; plain storage. `Point` is a vector of two or three doubles.
template <class Point>
class FixedPolygon {
public:
    /// Enough for the shadow of a box cut by a plane (10 vertices) and then by a window (14).
    static constexpr std::size_t capacity = 16;

    [[nodiscard]] constexpr std::size_t size() const { return size_; }

    [[nodiscard]] constexpr bool empty() const { return size_ == 0; }

    [[nodiscard]] constexpr const Point& operator[](std::size_t i) const { return points_[i]; }

    /// The vertex after vertex i, cyclically.
    [[nodiscard]] constexpr const Point& after(std::size_t i) const {
        return points_[i + 1 == size_ ? 0 : i + 1];
    }

    [[nodiscard]] constexpr const Point* begin() const { return points_.data(); }

    [[nodiscard]] constexpr const Point* end() const { return points_.data() + size_; }

    /// Appends a vertex; size() < capacity.
    constexpr void push_back(const Point& point) {
        assert(size_ < capacity);
        points_[size_++] = point;
    }

    constexpr void pop_back() { --size_; }

private:
    std::array<Point, capacity> points_{};
    std::size_t size_ = 0;
};

/// The part of a convex polygon where `height(point)`, an affine function, is >= 0: one vertex more
/// at most. Fewer than three vertices may remain (a touched edge or corner). [Sutherland74]
template <class Point, class Height>
[[nodiscard]] constexpr FixedPolygon<Point>
clipped(const FixedPolygon<Point>& polygon, const Height& height) {
    FixedPolygon<Point> kept;
    if (polygon.empty()) return kept;
    Point from = polygon[polygon.size() - 1];
    double from_height = height(from);
    for (const Point& to : polygon) {
        const double to_height = height(to);
        // The crossing is computed from the inner end outward whichever way the edge runs, so that
        // neighbors that share the edge cut it at the same point.
        if (from_height > 0 && to_height < 0)
            kept.push_back(from + (to - from) * (from_height / (from_height - to_height)));
        if (from_height < 0 && to_height > 0)
            kept.push_back(to + (from - to) * (to_height / (to_height - from_height)));
        if (to_height >= 0) kept.push_back(to);
        from = to;
        from_height = to_height;
    }
    return kept;
}

} // namespace raywise
