// Rays and hits, as plain data.
#pragma once

#include <raywise/core/ids.hpp>
#include <raywise/geometry/vec.hpp>

#include <limits>

namespace raywise {

/// The points origin + t * direction for t in the closed interval [t_min, t_max]. The direction
/// need not be a unit vector; t is in units of its length. A ray that is not `is_valid` misses
/// everything.
struct Ray {
    Vec3 origin = {};
    Vec3 direction = {};
    float t_min = 0;
    float t_max = std::numeric_limits<float>::infinity();
    PrimId excluded =
        no_prim; ///< a triangle that this ray does not hit, such as the one it starts on
};

/// Origin finite, direction finite and not zero, t_min <= t_max, t_min >= 0, no NaN.
[[nodiscard]] inline bool is_valid(const Ray& ray) {
    return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3{} &&
           ray.t_min >= 0 && ray.t_min <= ray.t_max;
}

[[nodiscard]] constexpr Vec3 point_at(const Ray& ray, float t) {
    return ray.origin + ray.direction * t;
}

/// Where a ray meets a triangle.
struct Hit {
    float t = std::numeric_limits<float>::infinity();
    float u = 0; ///< barycentric weight of vertex 1
    float v = 0; ///< barycentric weight of vertex 2
    PrimId prim = no_prim;
    bool front = false; ///< whether the ray sees the vertices counter-clockwise
};

/// The order of hits along a ray: by t, equal t by triangle id.
[[nodiscard]] constexpr bool is_closer(const Hit& a, const Hit& b) {
    return a.t < b.t || (a.t == b.t && a.prim < b.prim);
}

} // namespace raywise
