#include <raywise/geometry/obb.hpp>

#include "geometry/exit_bound.hpp"
#include "geometry/round_outward.hpp"

#include <raywise/core/rounding.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <cmath>

namespace raywise {

namespace {

constexpr double slack = gamma_bound(8, double_epsilon);

/// Bounds of the rounding errors of the frame coordinates of `point - center`.
Vec3d coordinate_errors(const Obb& box, Vec3d point) {
    const Vec3d reach = abs(point) + abs(box.center);
    return to_frame({abs(box.frame.right), abs(box.frame.up), abs(box.frame.forward)}, reach) *
           slack;
}

} // namespace

bool contains(const Obb& obb, Vec3d point) {
    const Vec3d at = abs(to_frame(obb.frame, point - obb.center));
    const Vec3d limit = obb.half + coordinate_errors(obb, point);
    return at.x <= limit.x && at.y <= limit.y && at.z <= limit.z;
}

bool contains(const Obb& obb, const Aabb& box) {
    if (box.is_empty()) return false;
    for (int i = 0; i < 8; ++i)
        if (!contains(obb, to_double(box.vertex(i)))) return false;
    return true;
}

float exit_parameter(const Obb& obb, const Ray& ray) {
    const Vec3d origin = to_double(ray.origin);
    const Vec3d direction = to_double(ray.direction);
    const Vec3d at = to_frame(obb.frame, origin - obb.center);
    const Vec3d at_error = coordinate_errors(obb, origin);
    const Vec3d rate = to_frame(obb.frame, direction);
    const Frame magnitudes{abs(obb.frame.right), abs(obb.frame.up), abs(obb.frame.forward)};
    const Vec3d rate_error = to_frame(magnitudes, abs(direction)) * slack;
    ExitBound bound;
    for (int axis = 0; axis < 3; ++axis) {
        bound.add(obb.half[axis] - at[axis], at_error[axis], -rate[axis], rate_error[axis]);
        bound.add(obb.half[axis] + at[axis], at_error[axis], rate[axis], rate_error[axis]);
    }
    return bound.parameter();
}

Aabb bounds(const Obb& obb) {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        TrackedSum lo(obb.center[axis]);
        TrackedSum hi(obb.center[axis]);
        const auto add = [&](Vec3d direction, double half) {
            lo.add(-std::abs(direction[axis]), half);
            hi.add(std::abs(direction[axis]), half);
        };
        add(obb.frame.right, obb.half.x);
        add(obb.frame.up, obb.half.y);
        add(obb.frame.forward, obb.half.z);
        box.lo[axis] = lo.below();
        box.hi[axis] = hi.above();
    }
    return box;
}

} // namespace raywise
