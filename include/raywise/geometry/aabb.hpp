// Axis-aligned boxes: closed sets, flat ones included.
#pragma once

#include <raywise/geometry/vec.hpp>

#include <limits>

namespace raywise {

/// The closed box [lo, hi]. Flat boxes and points are valid. The default is the empty box (lo =
/// +inf, hi = -inf): it overlaps nothing, contains nothing, and is the identity of `unite`.
struct Aabb {
    Vec3 lo{
        std::numeric_limits<float>::infinity(),
        std::numeric_limits<float>::infinity(),
        std::numeric_limits<float>::infinity()
    };
    Vec3 hi{
        -std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()
    };

    friend constexpr bool operator==(const Aabb&, const Aabb&) = default;

    /// True also when a coordinate is NaN.
    [[nodiscard]] constexpr bool is_empty() const {
        return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z);
    }

    [[nodiscard]] constexpr Vec3 size() const { return hi - lo; }

    /// Halved before the sum, so that no finite box overflows.
    [[nodiscard]] constexpr Vec3 center() const { return lo * 0.5F + hi * 0.5F; }

    /// Vertex i in 0..7: i = 4 [x = hi] + 2 [y = hi] + [z = hi]; 7 - i is opposite to i.
    [[nodiscard]] constexpr Vec3 vertex(int i) const {
        return {(i & 4) != 0 ? hi.x : lo.x, (i & 2) != 0 ? hi.y : lo.y, (i & 1) != 0 ? hi.z : lo.z};
    }
};

[[nodiscard]] constexpr Aabb unite(const Aabb& a, const Aabb& b) {
    return {min(a.lo, b.lo), max(a.hi, b.hi)};
}

[[nodiscard]] constexpr Aabb unite(const Aabb& a, Vec3 point) {
    return {min(a.lo, point), max(a.hi, point)};
}

/// The common part; empty when there is none.
[[nodiscard]] constexpr Aabb intersect(const Aabb& a, const Aabb& b) {
    return {max(a.lo, b.lo), min(a.hi, b.hi)};
}

/// Whether the boxes share a point; touching counts. False for an empty box and for NaN.
[[nodiscard]] constexpr bool overlaps(const Aabb& a, const Aabb& b) {
    return a.lo.x <= b.hi.x && a.hi.x >= b.lo.x && a.lo.y <= b.hi.y && a.hi.y >= b.lo.y &&
           a.lo.z <= b.hi.z && a.hi.z >= b.lo.z;
}

/// Whether every point of `inner` is in `outer`; an empty `inner` is in nothing (section 2.0 of the
/// method: no answers about what is not there).
[[nodiscard]] constexpr bool contains(const Aabb& outer, const Aabb& inner) {
    return !inner.is_empty() && outer.lo.x <= inner.lo.x && outer.lo.y <= inner.lo.y &&
           outer.lo.z <= inner.lo.z && outer.hi.x >= inner.hi.x && outer.hi.y >= inner.hi.y &&
           outer.hi.z >= inner.hi.z;
}

/// Whether the point is in the closed box; exact. False for NaN and for an empty box.
[[nodiscard]] constexpr bool contains(const Aabb& box, Vec3d point) {
    const Vec3d lo = to_double(box.lo);
    const Vec3d hi = to_double(box.hi);
    return lo.x <= point.x && point.x <= hi.x && lo.y <= point.y && point.y <= hi.y &&
           lo.z <= point.z && point.z <= hi.z;
}

/// Half the surface area; 0 for an empty box and for a point, positive for a flat box.
[[nodiscard]] constexpr float half_area(const Aabb& box) {
    if (box.is_empty()) return 0;
    const Vec3 s = box.size();
    return s.x * s.y + s.y * s.z + s.z * s.x;
}

} // namespace raywise
