// Bodies of ray_triangle.hpp that a traversal's inner loop must see.
#pragma once

#include <raywise/geometry/ray_triangle.hpp>

namespace raywise {

/// With e = 2^-24, exact sheared coordinates x = Ax - (dx/dz) Az and their computed values x', let
/// s be the largest |x'| or |y'| and z the largest |Az| of the three vertices. Rounding the
/// difference A, the ratio, their product and the final difference gives
///     |x' - x| <= e |Ax| + 3 e |Az| + e |x'| <= 4 e z + 2 e s =: E   (second order left out),
/// hence for an edge function x1 y2 - y1 x2, with its three roundings,
///     error <= 4 s E + 2 E^2 + 4 e s^2 <= e r (20 s + 32 e r),   r = z + s.
/// 24 and 48 stand for 20 and 32, to cover second order terms and the rounding of the bound. A
/// contracted multiply-add has fewer roundings and stays below. Underflow adds at most a few times
/// 2^-126 to a product, below the absolute term; r < 2^62 excludes overflow.
inline bool ExactKernel::surely_misses(const Triangle& triangle) const {
    const auto& [v0, v1, v2] = triangle;
    const float az = component(v0, z_) - origin_z_;
    const float bz = component(v1, z_) - origin_z_;
    const float cz = component(v2, z_) - origin_z_;
    const float ax = (component(v0, x_) - origin_x_) - shear_x_ * az;
    const float ay = (component(v0, y_) - origin_y_) - shear_y_ * az;
    const float bx = (component(v1, x_) - origin_x_) - shear_x_ * bz;
    const float by = (component(v1, y_) - origin_y_) - shear_y_ * bz;
    const float cx = (component(v2, x_) - origin_x_) - shear_x_ * cz;
    const float cy = (component(v2, y_) - origin_y_) - shear_y_ * cz;

    const float u = bx * cy - by * cx;
    const float v = cx * ay - cy * ax;
    const float w = ax * by - ay * bx;

    // NOLINTBEGIN(modernize-min-max-use-initializer-list): lists go through memory.
    const float depth = std::max(std::max(std::abs(az), std::abs(bz)), std::abs(cz));
    const float across = std::max(
        std::max(std::max(std::abs(ax), std::abs(ay)), std::max(std::abs(bx), std::abs(by))),
        std::max(std::abs(cx), std::abs(cy))
    );
    const float size = depth + across;
    const float bound = size * (24 * 0x1p-24F * across + 48 * 0x1p-48F * size) + 0x1p-120F;
    const float least = std::min(std::min(u, v), w);
    const float greatest = std::max(std::max(u, v), w);
    // NOLINTEND(modernize-min-max-use-initializer-list)
    return least < -bound && greatest > bound && size < 0x1p62F;
}

inline std::optional<Hit>
FastKernel::operator()(const Triangle& triangle, PrimId id, float t_max) const {
    const Vec3 edge1 = triangle.v1 - triangle.v0;
    const Vec3 edge2 = triangle.v2 - triangle.v0;
    const Vec3 across = cross(ray_->direction, edge2);
    const float volume = dot(edge1, across);
    if (volume == 0 || id == ray_->excluded) return std::nullopt;
    const float inverse = 1 / volume;
    const Vec3 from_v0 = ray_->origin - triangle.v0;
    const float u = dot(from_v0, across) * inverse;
    if (!(u >= 0 && u <= 1)) return std::nullopt;
    const Vec3 upward = cross(from_v0, edge1);
    const float v = dot(ray_->direction, upward) * inverse;
    if (!(v >= 0 && u + v <= 1)) return std::nullopt;
    const float t = dot(edge2, upward) * inverse;
    if (!(t >= ray_->t_min && t <= t_max && t < std::numeric_limits<float>::infinity()))
        return std::nullopt;
    return Hit{t + 0.0F, u, v, id, volume > 0};
}

} // namespace raywise
