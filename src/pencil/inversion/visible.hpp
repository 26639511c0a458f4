// Whether and where a triangle may be seen in the window that the rays of a face are in.
#pragma once

#include "pencil/inversion/drawn.hpp"
#include "pencil/inversion/extremes.hpp"
#include "pencil/inversion/facing.hpp"
#include "pencil/inversion/ray_tiles.hpp"

#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <hwy/base.h>

#include <array>
#include <limits>

namespace raywise::detail {

HWY_INLINE bool is_beside(const Drawn& t, const Window& window) {
    return t.u_lo > window.u_hi || t.u_hi < window.u_lo || t.v_lo > window.v_hi ||
           t.v_hi < window.v_lo;
}

HWY_INLINE void widen(Drawn& t, double slack) {
    t.u_lo -= slack;
    t.u_hi += slack;
    t.v_lo -= slack;
    t.v_hi += slack;
}

/// Along `direction`, for a triangle whose points and bounds are set: sets what the window shows.
HWY_INLINE bool
show_parallel(Drawn& t, const Window& window, Vec3 direction, const Triangle& triangle) {
    widen(t, 0x1p-48 * t.size);
    if (is_beside(t, window)) return false;
    t.u = {t.p[0].x, t.p[1].x, t.p[2].x};
    t.v = {t.p[0].y, t.p[1].y, t.p[2].y};
    t.is_flat = true;
    if (find_side(t, 0x1p-50 * t.size)) return true;
    // Seen edge-on it is never hit.
    const int sign = exact_facing(direction, triangle);
    t.side = direction[dominant_axis(direction)] < 0 ? -sign : sign;
    t.is_flat = false;
    return sign != 0;
}

/// Whether all points lie on the far side of one side of the window.
HWY_INLINE bool is_beside_radial(const Drawn& t, const Window& window, double room) {
    const double noise = 0x1p-44 * t.size;
    const auto beside = [&](auto&& outside) {
        return outside(t.p[0]) && outside(t.p[1]) && outside(t.p[2]);
    };
    return beside([&](auto& p) { return p.x > (window.u_hi + room) * p.h + noise; }) ||
           beside([&](auto& p) { return (window.u_lo - room) * p.h > p.x + noise; }) ||
           beside([&](auto& p) { return p.y > (window.v_hi + room) * p.h + noise; }) ||
           beside([&](auto& p) { return (window.v_lo - room) * p.h > p.y + noise; });
}

/// From an apex, for a triangle whose points, depths, size and distance are set: sets what the
/// window shows.
HWY_INLINE bool show_radial(Drawn& t, const Window& window) {
    const double aside = window.reach > 0 ? deviation(t, window.reach) : 0;
    const double slack = 0x1p-44 + aside;
    if (is_beside_radial(t, window, slack + 0x1p-40)) return false;
    const auto& [a, b, c] = t.p;
    t.is_flat = false;
    t.side = 0;
    const bool reaches_behind = !(least_of(a.h, b.h, c.h) > 0x1p-20 * t.size);
    if (reaches_behind) {
        constexpr double everywhere = std::numeric_limits<double>::infinity();
        t.u_lo = t.v_lo = -everywhere;
        t.u_hi = t.v_hi = everywhere;
        return true;
    }
    const std::array<double, 3> inverse{1 / a.h, 1 / b.h, 1 / c.h};
    t.u = {a.x * inverse[0], b.x * inverse[1], c.x * inverse[2]};
    t.v = {a.y * inverse[0], b.y * inverse[1], c.y * inverse[2]};
    t.u_lo = least_of(t.u[0], t.u[1], t.u[2]);
    t.u_hi = greatest_of(t.u[0], t.u[1], t.u[2]);
    t.v_lo = least_of(t.v[0], t.v[1], t.v[2]);
    t.v_hi = greatest_of(t.v[0], t.v[1], t.v[2]);
    const double greatest = greater(greater(-t.u_lo, t.u_hi), greater(-t.v_lo, t.v_hi));
    t.is_flat = greatest < 64 && find_side(t, 0x1p-50 * greatest);
    widen(t, slack + 0x1p-48 * greatest);
    return !is_beside(t, window);
}

} // namespace raywise::detail
