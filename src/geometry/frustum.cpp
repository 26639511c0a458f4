#include <raywise/geometry/frustum.hpp>

#include "geometry/exit_bound.hpp"
#include "geometry/round_outward.hpp"

#include <raywise/core/rounding.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>

namespace raywise {

namespace {

constexpr double slack = gamma_bound(8, double_epsilon);

/// Bounds of the rounding errors of the frame coordinates of a vector whose components are sums of
/// terms of magnitude `reach`.
Vec3d coordinate_errors(const Frame& frame, Vec3d reach) {
    return to_frame({abs(frame.right), abs(frame.up), abs(frame.forward)}, reach) * slack;
}

} // namespace

bool contains(const Frustum& frustum, Vec3d point) {
    const Vec3d at = to_frame(frustum.frame, point - frustum.eye);
    const Vec3d error = coordinate_errors(frustum.frame, abs(point) + abs(frustum.eye));
    const double depth = at.z + error.z;
    return depth >= frustum.near && at.z - error.z <= frustum.far &&
           std::abs(at.x) - error.x <= depth * frustum.tan_x &&
           std::abs(at.y) - error.y <= depth * frustum.tan_y;
}

bool contains(const Frustum& frustum, const Aabb& box) {
    if (box.is_empty()) return false;
    for (int i = 0; i < 8; ++i)
        if (!contains(frustum, to_double(box.vertex(i)))) return false;
    return true;
}

float exit_parameter(const Frustum& frustum, const Ray& ray) {
    const Vec3d origin = to_double(ray.origin);
    const Vec3d direction = to_double(ray.direction);
    const Vec3d at = to_frame(frustum.frame, origin - frustum.eye);
    const Vec3d at_error = coordinate_errors(frustum.frame, abs(origin) + abs(frustum.eye));
    const Vec3d rate = to_frame(frustum.frame, direction);
    const Vec3d rate_error = coordinate_errors(frustum.frame, abs(direction));
    ExitBound bound;
    bound.add(at.z - frustum.near, at_error.z, rate.z, rate_error.z);
    bound.add(frustum.far - at.z, at_error.z, -rate.z, rate_error.z);
    const auto add_pair = [&](int side, double tangent) {
        // The products with the tangent round once more: a little above the tracked errors.
        const double value_error = (at_error.z * tangent + at_error[side]) * 1.25;
        const double slope_error = (rate_error.z * tangent + rate_error[side]) * 1.25;
        for (const double sign : {-1.0, 1.0})
            bound.add(
                at.z * tangent + sign * at[side],
                value_error,
                rate.z * tangent + sign * rate[side],
                slope_error
            );
    };
    add_pair(0, frustum.tan_x);
    add_pair(1, frustum.tan_y);
    return bound.parameter();
}

Aabb bounds(const Frustum& frustum) {
    const Frame& frame = frustum.frame;
    Aabb box;
    for (const double depth : {frustum.near, frustum.far}) {
        const double x = depth * frustum.tan_x;
        const double y = depth * frustum.tan_y;
        for (int axis = 0; axis < 3; ++axis) {
            TrackedSum lo(frustum.eye[axis]);
            TrackedSum hi(frustum.eye[axis]);
            for (TrackedSum* sum : {&lo, &hi}) {
                const double outward = sum == &lo ? -1 : 1;
                sum->add(frame.forward[axis], depth);
                sum->add(outward * std::abs(frame.right[axis]), x);
                sum->add(outward * std::abs(frame.up[axis]), y);
                sum->widen(std::fma(depth, frustum.tan_x, -x) * frame.right[axis]);
                sum->widen(std::fma(depth, frustum.tan_y, -y) * frame.up[axis]);
            }
            box.lo[axis] = std::min(box.lo[axis], lo.below());
            box.hi[axis] = std::max(box.hi[axis], hi.above());
        }
    }
    return box;
}

} // namespace raywise
