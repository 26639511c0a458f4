// Ray against plane.
#pragma once

#include <raywise/geometry/ray.hpp>

#include <optional>

namespace raywise {

/// t = n . (point - origin) / n . direction, for a normal n of any nonzero length, computed in
/// double and rounded to float. Nothing when n . direction is 0 (a ray in the plane included), when
/// t is not finite or not in [t_min, t_max], or when the ray is not `is_valid`. n . direction is
/// summed exactly, so a parallel ray is recognized without a tolerance.
[[nodiscard]] std::optional<float> intersect_plane(const Ray& ray, Vec3 point, Vec3 normal);

} // namespace raywise
