#include <raywise/geometry/ray_box.hpp>

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <optional>

namespace raywise {

std::optional<Interval> intersect(const Ray& ray, const Aabb& box) {
    if (!is_valid(ray) || box.is_empty()) return std::nullopt;
    auto entry = static_cast<double>(ray.t_min);
    auto exit = static_cast<double>(ray.t_max);
    const Vec3d to_lo = to_double(box.lo) - to_double(ray.origin);
    const Vec3d to_hi = to_double(box.hi) - to_double(ray.origin);
    const Vec3d d = to_double(ray.direction);
    for (int axis = 0; axis < 3; ++axis) {
        if (d[axis] == 0) {
            if (!(to_lo[axis] <= 0 && 0 <= to_hi[axis])) return std::nullopt;
            continue;
        }
        const double a = to_lo[axis] / d[axis];
        const double b = to_hi[axis] / d[axis];
        entry = std::max(entry, std::min(a, b));
        exit = std::min(exit, std::max(a, b));
    }
    if (!(entry <= exit)) return std::nullopt;
    return Interval{static_cast<float>(entry), static_cast<float>(exit)};
}

} // namespace raywise
