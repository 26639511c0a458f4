// What a hit is, in whole numbers of any length and by formulas of its own: the oracle of the exact
// kernel.
#pragma once

#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle.hpp>

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

namespace raywise::oracle {

/// Coordinates in units of a power of two that makes them whole: no fractions to reduce.
struct Integer3 {
    mpz_class x, y, z;
};

/// The exponent of the last bit of a finite float, or more.
inline int last_bit(float x) {
    return x == 0 ? 1000 : std::max(std::ilogb(x) - 23, -149);
}

inline int last_bit(Vec3 a) {
    return std::min({last_bit(a.x), last_bit(a.y), last_bit(a.z)});
}

/// a / 2^unit.
inline Integer3 in_units(Vec3 a, int unit) {
    const auto whole = [&](float x) {
        return mpz_class(std::ldexp(static_cast<double>(x), -unit));
    };
    return {whole(a.x), whole(a.y), whole(a.z)};
}

inline Integer3 operator-(const Integer3& a, const Integer3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline mpz_class dot(const Integer3& a, const Integer3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline Integer3 cross(const Integer3& a, const Integer3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// numerator / denominator * 2^exponent.
inline mpq_class fraction(const mpz_class& numerator, const mpz_class& denominator, int exponent) {
    mpq_class result(numerator, denominator);
    result.canonicalize();
    const auto shift = static_cast<mp_bitcnt_t>(std::abs(exponent));
    return exponent >= 0 ? mpq_class(result << shift) : mpq_class(result >> shift);
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
    const int unit = std::min(
        {last_bit(ray.origin), last_bit(triangle.v0), last_bit(triangle.v1), last_bit(triangle.v2)}
    );
    const int direction_unit = last_bit(ray.direction);
    const Integer3 d = in_units(ray.direction, direction_unit);
    const Integer3 v0 = in_units(triangle.v0, unit);
    const Integer3 from_v0 = in_units(ray.origin, unit) - v0;
    const Integer3 e1 = in_units(triangle.v1, unit) - v0;
    const Integer3 e2 = in_units(triangle.v2, unit) - v0;
    const Integer3 n = cross(e1, e2);
    const mpz_class slope = dot(n, d);
    if (slope == 0 || id == ray.excluded) return std::nullopt;
    const mpz_class rise = -dot(n, from_v0);
    // The point less v0, times slope.
    const Integer3 p{
        slope * from_v0.x + rise * d.x,
        slope * from_v0.y + rise * d.y,
        slope * from_v0.z + rise * d.z
    };
    const mpz_class g11 = dot(e1, e1);
    const mpz_class g12 = dot(e1, e2);
    const mpz_class g22 = dot(e2, e2);
    const mpz_class p1 = dot(p, e1);
    const mpz_class p2 = dot(p, e2);
    const mpz_class area = (g11 * g22 - g12 * g12) * slope; // of the sign of slope
    const mpz_class u = p1 * g22 - p2 * g12;
    const mpz_class v = p2 * g11 - p1 * g12;
    const mpz_class w = area - u - v;
    const int side = sgn(slope);
    if (sgn(u) * side < 0 || sgn(v) * side < 0 || sgn(w) * side < 0) return std::nullopt;
    const float t = nearest_float(fraction(rise, slope, unit - direction_unit)) + 0.0F;
    if (!std::isfinite(t) || t < ray.t_min || t > ray.t_max) return std::nullopt;
    return Hit{
        t, nearest_float(fraction(u, area, 0)), nearest_float(fraction(v, area, 0)), id, side < 0
    };
}

} // namespace raywise::oracle
