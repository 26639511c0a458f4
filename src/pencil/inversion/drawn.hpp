// A triangle as one picture shows it.
#pragma once

#include "pencil/inversion/extremes.hpp"
#include "pencil/inversion/face.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <hwy/base.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace raywise::detail {

struct Drawn {
    PrimId id;
    std::array<FacePoint, 3> p;
    double depth_lo, depth_hi;
    double size;     ///< no coordinate's magnitude is greater
    double distance; ///< radial: at most the largest coordinate of any point of the triangle
    bool is_flat;    ///< whether it is seen as the triangle of the points (u, v), on a known side
    std::array<double, 3> u, v;    ///< of a flat one
    double area;                   ///< twice the signed area of a flat one, approximately
    double area_error;             ///< relative
    int side;                      ///< sign of that area, surely
    double u_lo, u_hi, v_lo, v_hi; ///< where it may be seen; unbounded when it reaches behind
};

/// A triangle as seen from an apex in all directions: coordinates are relative to it.
struct Around {
    Vec3d a, b, c;
    Vec3d lo, hi;
    double size;     ///< no coordinate's magnitude is greater
    double distance; ///< at most the largest coordinate of any point of the triangle
};

/// A lower bound on the distance of the plane from the apex, in the largest of the coordinates.
inline double plane_distance(const Around& t) {
    const Vec3d normal = cross(t.b - t.a, t.c - t.a);
    const Vec3d n = abs(normal);
    const double volume = std::abs(dot(t.a, normal)) - 0x1p-46 * t.size * t.size * t.size;
    return volume > 0 ? volume / (n.x + n.y + n.z + 0x1p-46 * t.size * t.size) : 0;
}

HWY_INLINE Around look_around(Vec3d apex, const Triangle& triangle) {
    Around t; // NOLINT(*-member-init)
    t.a = to_double(triangle.v0) - apex;
    t.b = to_double(triangle.v1) - apex;
    t.c = to_double(triangle.v2) - apex;
    t.lo = min(min(t.a, t.b), t.c);
    t.hi = max(max(t.a, t.b), t.c);
    const auto greatest = [](const Vec3d& v) { return greatest_of(v.x, v.y, v.z); };
    t.size = greater(greatest(t.hi), greatest(-t.lo));
    t.distance = greater(greater(greatest(t.lo), greatest(-t.hi)), 0.0);
    if (t.distance < 0x1p-6 * t.size) t.distance = greater(t.distance, plane_distance(t));
    return t;
}

/// Whether the triangle may reach into the pyramid of a face of the cube, made wider by `slack`.
HWY_INLINE bool may_face(const Around& t, std::size_t face, double slack) {
    const int z = static_cast<int>(face / 2);
    const double most = (face % 2 == 0 ? t.hi[z] : -t.lo[z]) * (1 + slack);
    if (!(most > 0)) return false;
    const int x = (z + 1) % 3;
    const int y = (z + 2) % 3;
    return greater(t.lo[x], -t.hi[x]) <= most && greater(t.lo[y], -t.hi[y]) <= most;
}

/// Sets the bounds that follow from the points.
HWY_INLINE void measure_depth(Drawn& t) {
    const auto& [a, b, c] = t.p;
    t.depth_lo = least_of(a.depth, b.depth, c.depth);
    t.depth_hi = greatest_of(a.depth, b.depth, c.depth);
}

HWY_INLINE void measure_parallel(Drawn& t) {
    const auto& [a, b, c] = t.p;
    measure_depth(t);
    t.u_lo = least_of(a.x, b.x, c.x);
    t.u_hi = greatest_of(a.x, b.x, c.x);
    t.v_lo = least_of(a.y, b.y, c.y);
    t.v_hi = greatest_of(a.y, b.y, c.y);
    t.size = greater(
        greater(greater(-t.u_lo, t.u_hi), greater(-t.v_lo, t.v_hi)),
        greater(-t.depth_lo, t.depth_hi)
    );
}

/// By how much, in the picture, a ray of this reach may be off where it meets the triangle.
///
/// The float direction of a shadow ray is off by 2^-24 in each component, so at depth z, started at
/// depth s, the ray is seen at most 2 |u| 2^-24 |s / z - 1| aside, |u| <= 1. A point where it meets
/// a triangle at distance r > 8 * 2^-24 s is seen in the doubled window, hence z >= r / 2.
HWY_INLINE double deviation(const Drawn& t, double reach) {
    const double nearest = greater(t.distance / 2, least_of(t.p[0].h, t.p[1].h, t.p[2].h));
    return 2.1 * 0x1p-24 * greater(1.0, reach / nearest);
}

/// Sets area and side from u and v, which are within `error` of the exact ones. False: the side is
/// not sure.
HWY_INLINE bool find_side(Drawn& t, double error) {
    const double ax = t.u[1] - t.u[0], ay = t.v[1] - t.v[0];
    const double bx = t.u[2] - t.u[0], by = t.v[2] - t.v[0];
    const double across =
        greater(greater(std::abs(ax), std::abs(bx)), greater(std::abs(ay), std::abs(by)));
    t.area = ax * by - ay * bx;
    t.side = t.area > 0 ? 1 : -1;
    const double bound = 8 * error * (across + error) + 0x1p-50 * across * across;
    t.area_error = bound / std::abs(t.area);
    return std::abs(t.area) > 4 * bound;
}

} // namespace raywise::detail
