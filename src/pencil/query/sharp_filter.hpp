// A triangle against a ray in double arithmetic, where a list leaves a doubt. After [Woop13].
#pragma once

#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace raywise::pencil_detail {

/// Whether the ray hits the triangle within [t_min, t_max]; nothing when that is not sure.
///
/// All numbers are floats and their differences nearly exact, so the bound of
/// ExactKernel::surely_misses holds with e = 2^-53. The depth of the hit is z = sum(f z) / sum(f)
/// for the edge functions f, one sign all, each within b, and depths within e of themselves, at
/// most m: its numerator is within (3 b + 6 e S) m, its denominator within 3 b + 3 e S, S =
/// |sum(f)|, so z is within m (6 b / S + 12 e) with the roundings of the quotient, second order
/// terms left out; 8 and 16 stand for 6 and 12, and b <= S / 64 is asked for. Coordinates below
/// 2^60 do not overflow.
[[nodiscard]] inline std::optional<bool> sharp_hit(const Ray& ray, const Triangle& triangle) {
    constexpr double e = 0x1p-53;
    const int along = dominant_axis(ray.direction);
    const int across_u = (along + 1) % 3;
    const int across_v = (along + 2) % 3;
    const Vec3d origin = to_double(ray.origin);
    const Vec3d direction = to_double(ray.direction);
    const double shear_u = direction[across_u] / direction[along];
    const double shear_v = direction[across_v] / direction[along];
    const std::array<Vec3, 3> vertices{triangle.v0, triangle.v1, triangle.v2};
    std::array<double, 3> x{}, y{}, z{};
    double deep = 0;
    double wide = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d seen = to_double(vertices[i]) - origin;
        z[i] = seen[along];
        x[i] = seen[across_u] - shear_u * z[i];
        y[i] = seen[across_v] - shear_v * z[i];
        deep = std::max(deep, std::abs(z[i]));
        wide = std::max(wide, std::max(std::abs(x[i]), std::abs(y[i])));
    }
    const double a = x[1] * y[2] - y[1] * x[2];
    const double b = x[2] * y[0] - y[2] * x[0];
    const double c = x[0] * y[1] - y[0] * x[1];
    const double size = deep + wide;
    const double bound = size * (24 * e * wide + 48 * e * e * size) + 0x1p-600;
    const double least = std::min(std::min(a, b), c);
    const double greatest = std::max(std::max(a, b), c);
    if (least < -bound && greatest > bound) return false;
    if (!(least > bound || greatest < -bound)) return std::nullopt;
    const double sum = a + b + c;
    const double weight = std::abs(sum);
    if (!(bound * 64 <= weight)) return std::nullopt;
    const double t = (a * z[0] + b * z[1] + c * z[2]) / sum / direction[along];
    const double speed = std::abs(direction[along]);
    // The depth's error, and what rounding t to float may do.
    const double error =
        deep * (8 * bound / weight + 16 * e) / speed + std::abs(t) * 0x1p-23 + 0x1p-149;
    const auto t_min = static_cast<double>(ray.t_min);
    const double t_max =
        static_cast<double>(std::min(ray.t_max, std::numeric_limits<float>::max()));
    if (t - error >= t_min && t + error <= t_max) return true;
    if (t + error < t_min || t - error > static_cast<double>(ray.t_max)) return false;
    return std::nullopt;
}

} // namespace raywise::pencil_detail
