#include <raywise/geometry/ray_plane.hpp>

#include "geometry/detail/expansion.hpp"

#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <cmath>
#include <optional>

namespace raywise {

namespace {

using Sum = detail::Expansion<12>;

/// normal . (a - b).
Sum exact_dot(Vec3 normal, Vec3 a, Vec3 b) {
    const Vec3d n = to_double(normal);
    return detail::difference(a.x, b.x) * n.x + detail::difference(a.y, b.y) * n.y +
           detail::difference(a.z, b.z) * n.z;
}

} // namespace

std::optional<float> intersect_plane(const Ray& ray, Vec3 point, Vec3 normal) {
    if (!is_valid(ray) || !is_finite(point) || !is_finite(normal)) return std::nullopt;
    const Sum rise = exact_dot(normal, ray.direction, Vec3{});
    if (rise.sign() == 0) return std::nullopt;
    // Adding +0 turns -0 into +0.
    const float t =
        static_cast<float>(exact_dot(normal, point, ray.origin).estimate() / rise.estimate()) +
        0.0F;
    if (!std::isfinite(t) || !(t >= ray.t_min && t <= ray.t_max)) return std::nullopt;
    return t;
}

} // namespace raywise
