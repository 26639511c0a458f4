// The map that makes rays through one apex run along one axis: the perspective map onto a face of a
// world-aligned cube around the apex.
#pragma once

#include <raywise/geometry/vec.hpp>

namespace raywise {

/// Coordinates (u, v, w) of points whose depth along `axis` from the apex is positive: u and v are
/// the positions on the cube face at depth 1, along the axes that follow `axis` cyclically, and
/// w = -1 / depth, which grows along rays that leave the apex. Rays through the apex have constant
/// (u, v); lines stay lines, so triangles in front of the apex stay triangles. w is negative and
/// tends to 0 at infinite depth.
class PerspectiveFrame {
public:
    /// The face of the cube around `apex` on the side `sign` (+1 or -1) of world axis `axis` (0 to
    /// 2). Throws Error when they are something else, or the apex is not finite.
    PerspectiveFrame(Vec3d apex, int axis, int sign);

    /// The face through which `direction` leaves the cube: that of its dominant axis. Throws Error
    /// when the direction is zero or not finite.
    static PerspectiveFrame facing(Vec3d apex, Vec3d direction);

    /// Depth of a point along the axis; the map is defined where it is > 0.
    [[nodiscard]] double depth(Vec3d point) const { return (point[axis_] - apex_[axis_]) * sign_; }

    /// Whether the point is in the closed pyramid of the face: depth > 0, |u| <= 1, |v| <= 1.
    [[nodiscard]] bool contains(Vec3d point) const;

    /// Defined for depth(point) > 0.
    [[nodiscard]] Vec3d to_frame(Vec3d point) const {
        const Vec3d from_apex = point - apex_;
        const double per_depth = 1 / (from_apex[axis_] * sign_);
        return {from_apex[u_axis()] * per_depth, from_apex[v_axis()] * per_depth, -per_depth};
    }

    /// The inverse of `to_frame`, for w < 0.
    [[nodiscard]] Vec3d from_frame(Vec3d coordinates) const {
        const double depth = -1 / coordinates.z;
        Vec3d from_apex;
        from_apex[axis_] = depth * sign_;
        from_apex[u_axis()] = coordinates.x * depth;
        from_apex[v_axis()] = coordinates.y * depth;
        return apex_ + from_apex;
    }

    [[nodiscard]] Vec3d apex() const { return apex_; }

    [[nodiscard]] int axis() const { return axis_; }

    [[nodiscard]] int sign() const { return sign_ > 0 ? 1 : -1; }

    /// The world axes of u and v.
    [[nodiscard]] int u_axis() const { return (axis_ + 1) % 3; }

    [[nodiscard]] int v_axis() const { return (axis_ + 2) % 3; }

private:
    Vec3d apex_;
    int axis_;
    double sign_;
};

} // namespace raywise
