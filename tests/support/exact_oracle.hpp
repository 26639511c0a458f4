// What a hit is, in rational numbers and by formulas of its own: the oracle of the exact kernel.
#pragma once

#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle.hpp>

#include <gmpxx.h>

#include <cmath>
#include <limits>
#include <optional>

namespace raywise::oracle {

struct Rational3 {
    mpq_class x, y, z;
};

inline Rational3 exact(Vec3 a) {
    return {
        mpq_class(static_cast<double>(a.x)),
        mpq_class(static_cast<double>(a.y)),
        mpq_class(static_cast<double>(a.z))
    };
}

inline Rational3 minus(const Rational3& a, const Rational3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline mpq_class dot(const Rational3& a, const Rational3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline Rational3 cross(const Rational3& a, const Rational3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The nearest float, ties to even, found by bisection of the ordered floats: slow and obvious.
inline float nearest_float(const mpq_class& x) {
    const mpq_class size = abs(x);
    const mpq_class greatest(static_cast<double>(std::numeric_limits<float>::max()));
    const mpq_class half_step(0x1p103);
    const float sign = sgn(x) < 0 ? -1.0F : 1.0F;
    if (size >= greatest + half_step) return sign * std::numeric_limits<float>::infinity();
    float below = static_cast<float>(size.get_d());
    if (std::isinf(below)) below = std::numeric_limits<float>::max();
    while (mpq_class(static_cast<double>(below)) > size)
        below = std::nextafter(below, 0.0F);
    for (;;) {
        const float above = std::nextafter(below, std::numeric_limits<float>::infinity());
        if (std::isinf(above)) return sign * below;
        const mpq_class low(static_cast<double>(below));
        const mpq_class high(static_cast<double>(above));
        if (high <= size) {
            below = above;
            continue;
        }
        const mpq_class to_low = size - low;
        const mpq_class to_high = high - size;
        if (to_low < to_high) return sign * below;
        if (to_high < to_low) return sign * above;
        // A tie: the even one divides by twice the spacing.
        const mpq_class steps = low / (high - low);
        const bool low_is_even = mpz_even_p(steps.get_num_mpz_t()) != 0;
        return sign * (low_is_even ? below : above);
    }
}

/// Solves for the point where the line meets the plane, then for its barycentric coordinates in the
/// plane by normal equations.
inline std::optional<Hit>
intersect(const Ray& ray, const Triangle& triangle, PrimId id = PrimId{0}) {
    const Rational3 o = exact(ray.origin);
    const Rational3 d = exact(ray.direction);
    const Rational3 v0 = exact(triangle.v0);
    const Rational3 e1 = minus(exact(triangle.v1), v0);
    const Rational3 e2 = minus(exact(triangle.v2), v0);
    const Rational3 n = cross(e1, e2);
    const mpq_class slope = dot(n, d);
    if (slope == 0 || id == ray.excluded) return std::nullopt;
    const mpq_class t = dot(n, minus(v0, o)) / slope;
    const Rational3 p{o.x + t * d.x - v0.x, o.y + t * d.y - v0.y, o.z + t * d.z - v0.z};
    const mpq_class g11 = dot(e1, e1);
    const mpq_class g12 = dot(e1, e2);
    const mpq_class g22 = dot(e2, e2);
    const mpq_class p1 = dot(p, e1);
    const mpq_class p2 = dot(p, e2);
    const mpq_class area = g11 * g22 - g12 * g12;
    const mpq_class u = (p1 * g22 - p2 * g12) / area;
    const mpq_class v = (p2 * g11 - p1 * g12) / area;
    if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
    const float rounded = nearest_float(t) + 0.0F;
    if (!std::isfinite(rounded) || rounded < ray.t_min || rounded > ray.t_max) return std::nullopt;
    return Hit{rounded, nearest_float(u), nearest_float(v), id, slope < 0};
}

} // namespace raywise::oracle
