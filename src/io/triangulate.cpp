#include "triangulate.hpp"

#include <raywise/geometry/vec.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace raywise::io_detail {

namespace {

/// Twice the polygon's vector area, by Newell's sums about its first corner. [Sutherland74]
Vec3d newell_normal(std::span<const Vec3> vertices, std::span<const std::uint32_t> corners) {
    const Vec3d origin = to_double(vertices[corners[0]]);
    Vec3d normal;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        normal = normal + cross(
                              to_double(vertices[corners[i]]) - origin,
                              to_double(vertices[corners[i + 1]]) - origin
                          );
    return normal;
}

/// The corner without the axis along which the normal is longest: exact, and counter-clockwise.
Vec2d flattened(Vec3d point, int axis, bool is_flipped) {
    const double u = point[(axis + 1) % 3];
    const double v = point[(axis + 2) % 3];
    return is_flipped ? Vec2d{v, u} : Vec2d{u, v};
}

/// A polygon whose ears are being cut: a ring of corners that shrinks.
class Ring {
public:
    explicit Ring(std::vector<Vec2d> points) : points_(std::move(points)) {
        const std::size_t count = points_.size();
        next_.resize(count);
        previous_.resize(count);
        is_refused_.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            next_[i] = (i + 1) % count;
            previous_[i] = (i + count - 1) % count;
        }
        for (std::size_t i = 0; i < count; ++i)
            if (turn(i) < 0) reflex_.push_back(i);
    }

    [[nodiscard]] std::size_t next(std::size_t i) const { return next_[i]; }

    [[nodiscard]] std::size_t previous(std::size_t i) const { return previous_[i]; }

    /// Whether it is a convex corner whose triangle holds no reflex corner. A cut changes the
    /// answer for its two neighbors alone [Meisters75], so that others are not asked twice.
    [[nodiscard]] bool is_ear(std::size_t i) {
        if (is_refused_[i] != 0) return false;
        is_refused_[i] = finds_ear(i) ? 0 : 1;
        return is_refused_[i] == 0;
    }

    void cut(std::size_t i) {
        is_refused_[next_[i]] = 0;
        is_refused_[previous_[i]] = 0;
        next_[previous_[i]] = next_[i];
        previous_[next_[i]] = previous_[i];
        // A neighbor can only become convex by the cut; the corner itself is gone.
        std::erase_if(reflex_, [&](std::size_t k) {
            return k == i || ((k == next_[i] || k == previous_[i]) && turn(k) >= 0);
        });
    }

private:
    [[nodiscard]] bool finds_ear(std::size_t i) const {
        if (turn(i) <= 0) return false;
        const Vec2d a = points_[previous_[i]];
        const Vec2d b = points_[i];
        const Vec2d c = points_[next_[i]];
        for (const std::size_t k : reflex_) {
            const Vec2d p = points_[k];
            // A corner in the same place as one of the three (a bridge to a hole) is not inside.
            if (p == a || p == b || p == c) continue;
            if (cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0)
                return false;
        }
        return true;
    }

    [[nodiscard]] double turn(std::size_t i) const {
        const Vec2d a = points_[previous_[i]];
        const Vec2d b = points_[i];
        return cross(b - a, points_[next_[i]] - b);
    }

    std::vector<Vec2d> points_;
    std::vector<std::size_t> next_;
    std::vector<std::size_t> previous_;
    std::vector<std::size_t> reflex_;
    std::vector<char> is_refused_;
};

} // namespace

void triangulate(
    std::span<const Vec3> vertices,
    std::span<const std::uint32_t> corners,
    std::vector<std::array<std::uint32_t, 3>>& triangles
) {
    const std::size_t count = corners.size();
    if (count < 3) return;
    const Vec3d normal = newell_normal(vertices, corners);
    const int axis = dominant_axis(normal);
    std::vector<Vec2d> points;
    points.reserve(count);
    for (const std::uint32_t corner : corners)
        points.push_back(flattened(to_double(vertices[corner]), axis, normal[axis] < 0));
    Ring ring(std::move(points));
    std::size_t at = 1; // so that a convex polygon becomes the fan about its first corner
    std::size_t looked = 0;
    for (std::size_t left = count; left > 3;) {
        // A whole round without an ear: not a simple polygon. Cut anyway, so that this ends.
        if (!ring.is_ear(at) && looked < left) {
            at = ring.next(at);
            ++looked;
            continue;
        }
        triangles.push_back({corners[ring.previous(at)], corners[at], corners[ring.next(at)]});
        ring.cut(at);
        at = ring.next(at);
        looked = 0;
        --left;
    }
    triangles.push_back({corners[ring.previous(at)], corners[at], corners[ring.next(at)]});
}

} // namespace raywise::io_detail
