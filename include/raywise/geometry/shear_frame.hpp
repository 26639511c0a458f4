// The map that makes parallel rays run along one axis: a shear along the dominant world axis.
// Unlike a rotation it keeps one coordinate of every point, and boxes aligned with it stay tight.
#pragma once

#include <raywise/geometry/vec.hpp>

namespace raywise {

/// Coordinates (u, v, w): w is the signed position along the dominant axis of the rays' direction,
/// u and v are the positions along the two axes that follow it cyclically, less what the ray has
/// moved sideways. Points on one ray have equal (u, v) up to rounding, and w grows along it. Affine
/// with determinant +-1: volumes, ratios of areas and the parameter of a ray are kept.
class ShearFrame {
public:
    /// Throws Error when the direction is zero or not finite. Any nonzero length.
    explicit ShearFrame(Vec3d direction);

    [[nodiscard]] Vec3d to_frame(Vec3d point) const {
        const double along = point[axis_];
        return {
            point[u_axis()] - along * slope_u_, point[v_axis()] - along * slope_v_, along * sign_
        };
    }

    /// The inverse of `to_frame`.
    [[nodiscard]] Vec3d from_frame(Vec3d coordinates) const {
        const double along = coordinates.z * sign_;
        Vec3d point;
        point[axis_] = along;
        point[u_axis()] = coordinates.x + along * slope_u_;
        point[v_axis()] = coordinates.y + along * slope_v_;
        return point;
    }

    /// The world axis along which the rays mainly run, 0 to 2.
    [[nodiscard]] int axis() const { return axis_; }

    /// The world axes of u and v.
    [[nodiscard]] int u_axis() const { return (axis_ + 1) % 3; }

    [[nodiscard]] int v_axis() const { return (axis_ + 2) % 3; }

private:
    int axis_;
    double sign_;    ///< of the direction along the axis
    double slope_u_; ///< sideways movement per unit along the axis, in [-1, 1]
    double slope_v_;
};

} // namespace raywise
