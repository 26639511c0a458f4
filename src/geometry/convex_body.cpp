#include <raywise/geometry/convex_body.hpp>

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>

namespace raywise {

BoxBody::BoxBody(const Aabb& box)
    : center_((to_double(box.lo) + to_double(box.hi)) * 0.5)
    , axes_{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}
    , half_((to_double(box.hi) - to_double(box.lo)) * 0.5)
    , reach_(abs(center_) + half_) {}

BoxBody::BoxBody(const Obb& box)
    : center_(box.center)
    , axes_{box.frame.right, box.frame.up, box.frame.forward}
    , half_(box.half)
    , reach_(
          abs(box.center) + abs(box.frame.right) * box.half.x + abs(box.frame.up) * box.half.y +
          abs(box.frame.forward) * box.half.z
      ) {}

Shadow BoxBody::shadow(Vec3d axis) const {
    const double middle = dot(axis, center_);
    const double radius = std::abs(dot(axis, axes_[0])) * half_.x +
                          std::abs(dot(axis, axes_[1])) * half_.y +
                          std::abs(dot(axis, axes_[2])) * half_.z;
    return {middle - radius, middle + radius};
}

FrustumBody::FrustumBody(const Frustum& frustum)
    : eye_(frustum.eye)
    , forward_(frustum.frame.forward)
    , right_(frustum.frame.right * frustum.tan_x)
    , up_(frustum.frame.up * frustum.tan_y)
    , near_(frustum.near)
    , far_(frustum.far)
    , normals_{
          forward_,
          forward_ * frustum.tan_x - frustum.frame.right,
          forward_ * frustum.tan_x + frustum.frame.right,
          forward_ * frustum.tan_y - frustum.frame.up,
          forward_ * frustum.tan_y + frustum.frame.up
      }
    , edges_{
          frustum.frame.right,
          frustum.frame.up,
          forward_ - right_ - up_,
          forward_ - right_ + up_,
          forward_ + right_ - up_,
          forward_ + right_ + up_
      }
    , reach_(abs(eye_) + (abs(forward_) + abs(right_) + abs(up_)) * far_) {}

Shadow FrustumBody::shadow(Vec3d axis) const {
    const double apex = dot(axis, eye_);
    const double along = dot(axis, forward_);
    const double spread = std::abs(dot(axis, right_)) + std::abs(dot(axis, up_));
    return {
        apex + std::min(near_ * (along - spread), far_ * (along - spread)),
        apex + std::max(near_ * (along + spread), far_ * (along + spread))
    };
}

TriangleBody::TriangleBody(const Triangle& triangle)
    : vertices_{to_double(triangle.v0), to_double(triangle.v1), to_double(triangle.v2)}
    , edges_{vertices_[1] - vertices_[0], vertices_[2] - vertices_[1], vertices_[0] - vertices_[2]}
    , normal_(cross(edges_[0], edges_[1]))
    , reach_(max(max(abs(vertices_[0]), abs(vertices_[1])), abs(vertices_[2]))) {
    constexpr double flat_sine_squared = 1e-24; // below it the normal is rounding noise
    const double product = dot(edges_[0], edges_[0]) * dot(edges_[1], edges_[1]);
    if (dot(normal_, normal_) > flat_sine_squared * product) normal_count_ = 1;
}

Shadow TriangleBody::shadow(Vec3d axis) const {
    const double a = dot(axis, vertices_[0]);
    const double b = dot(axis, vertices_[1]);
    const double c = dot(axis, vertices_[2]);
    return {std::min({a, b, c}), std::max({a, b, c})};
}

} // namespace raywise
