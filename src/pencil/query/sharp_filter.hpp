// The line filter in double: for triangles that reach far beyond the place where they are met, so
// that floats leave their depth in doubt.
#pragma once

#include <raywise/geometry/ray.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace raywise::pencil_detail {

/// Whether the ray, whose direction is longest along `axis` up to rounding, hits the triangle
/// within [t_min, t_max]; nothing when that is not sure. `record`: x of three vertices, then y,
/// then z.
///
/// All numbers are floats and their differences nearly exact, so the bound of
/// ExactKernel::surely_misses holds with e = 2^-53, and that of `cross` for the depth. Coordinates
/// below 2^60 do not overflow.
[[nodiscard]] inline std::optional<bool>
sharp_hit(const Ray& ray, const float* record, std::size_t axis) {
    constexpr double e = 0x1p-53;
    const std::size_t along = axis;
    const std::size_t across_u = (axis + 1) % 3;
    const std::size_t across_v = (axis + 2) % 3;
    const std::array<double, 3> origin{
        static_cast<double>(ray.origin.x),
        static_cast<double>(ray.origin.y),
        static_cast<double>(ray.origin.z)
    };
    const std::array<double, 3> direction{
        static_cast<double>(ray.direction.x),
        static_cast<double>(ray.direction.y),
        static_cast<double>(ray.direction.z)
    };
    const double shear_u = direction[across_u] / direction[along];
    const double shear_v = direction[across_v] / direction[along];
    std::array<double, 3> x{}, y{}, z{};
    double deep = 0;
    double wide = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto seen = [&](std::size_t k) {
            return static_cast<double>(record[3 * k + i]) - origin[k];
        };
        z[i] = seen(along);
        x[i] = seen(across_u) - shear_u * z[i];
        y[i] = seen(across_v) - shear_v * z[i];
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
