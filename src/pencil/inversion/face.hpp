// One picture of the world as a pencil sees it: the plane across parallel rays, or one face of the
// cube around an apex. Rays are points of the picture, triangles are triangles.
#pragma once

#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil.hpp>

#include <algorithm>
#include <cmath>

namespace raywise::detail {

/// A point of the world in homogeneous coordinates of a picture: it is seen at (x / h, y / h). h is
/// 1 for a parallel pencil, and the depth from the apex along the face's axis for a radial one.
/// `depth` grows away from the emitter, or toward it on a face that is reversed.
struct FacePoint {
    double x, y, h, depth;
};

/// A ray of the pencil in a picture: it is seen as the point (u, v); its interval [t_min, t_max] is
/// that of the depths [near, far].
struct FaceRay {
    double u, v, near, far;
    double start; ///< depth at t = 0
    double brink; ///< radial: a hit as near to the apex may be seen anywhere, or behind
    double scale; ///< with a depth: by how many units the rounding of t moves it
    bool leaves;  ///< whether depth grows with t
};

class Face {
public:
    /// The only picture of a parallel pencil. Coordinates are relative to `origin`: the nearer to
    /// the scene, the more precise.
    static Face parallel(Vec3 direction, Vec3 origin, bool reversed) {
        const int z = dominant_axis(direction);
        Face face(to_double(origin), z, direction[z] < 0 ? -1 : 1, false, reversed);
        const Vec3d d = to_double(direction);
        face.slope_x_ = d[face.x_] / d[z];
        face.slope_y_ = d[face.y_] / d[z];
        return face;
    }

    /// The face of the cube around the apex on side `index % 2` of axis `index / 2`.
    static Face radial(Vec3 apex, int index, bool reversed) {
        return {to_double(apex), index / 2, index % 2 == 0 ? 1 : -1, true, reversed};
    }

    [[nodiscard]] bool is_radial() const { return radial_; }

    [[nodiscard]] bool is_reversed() const { return depth_sign_ != sign_; }

    /// Whether depth grows along the world's axis.
    [[nodiscard]] double sign() const { return sign_; }

    [[nodiscard]] FacePoint point(Vec3 p) const {
        const Vec3d d = to_double(p) - origin_;
        const double along = d[z_];
        const double depth = along * depth_sign_;
        if (radial_) return {d[x_], d[y_], along * sign_, depth};
        return {d[x_] - slope_x_ * along, d[y_] - slope_y_ * along, 1, depth};
    }

    /// For a valid ray of the pencil, seen by this face.
    [[nodiscard]] FaceRay ray(const Ray& ray) const {
        const double speed = std::abs(static_cast<double>(ray.direction[z_]));
        const auto t_min = static_cast<double>(ray.t_min);
        const auto t_max = static_cast<double>(ray.t_max);
        const FacePoint from = point(ray.origin);
        const bool at_apex = radial_ && from.h == 0;
        FaceRay seen{};
        if (at_apex) {
            const Vec3d d = to_double(ray.direction);
            seen.u = d[x_] / speed;
            seen.v = d[y_] / speed;
        } else {
            seen.u = from.x / from.h;
            seen.v = from.y / from.h;
        }
        seen.leaves = radial_ ? at_apex : (ray.direction[z_] < 0) == (sign_ < 0);
        seen.start = from.depth;
        // A float direction passes the apex by a rounding, and a tiny negative t is rounded to 0.
        seen.brink = 8 * 0x1p-24 * std::abs(from.depth) + 0x1p-148 * speed;
        // Denormal t and depths have fewer bits.
        seen.scale = std::abs(from.depth) + 0x1p-124 * speed + 0x1p-120;
        if (seen.leaves != is_reversed()) {
            seen.near = from.depth + t_min * speed;
            seen.far = from.depth + t_max * speed;
        } else {
            seen.near = from.depth - t_max * speed;
            seen.far = from.depth - t_min * speed;
        }
        return seen;
    }

    /// The depth of a ray's point at t.
    [[nodiscard]] double depth_at(const Ray& ray, float t) const {
        return point(ray.origin).depth +
               static_cast<double>(ray.direction[z_]) * static_cast<double>(t) * depth_sign_;
    }

    /// The face of the cube that sees a ray of a radial pencil.
    [[nodiscard]] static int index_of(Vec3 apex, const Ray& ray) {
        const Vec3d d =
            ray.origin == apex ? to_double(ray.direction) : to_double(ray.origin) - to_double(apex);
        const int axis = dominant_axis(d);
        return 2 * axis + (d[axis] < 0 ? 1 : 0);
    }

private:
    Face(Vec3d origin, int z, int sign, bool radial, bool reversed)
        : origin_(origin)
        , z_(z)
        , x_((z + 1) % 3)
        , y_((z + 2) % 3)
        , sign_(sign)
        , depth_sign_(reversed ? -sign : sign)
        , radial_(radial) {}

    Vec3d origin_;
    int z_, x_, y_;
    double sign_;
    double depth_sign_;
    double slope_x_ = 0;
    double slope_y_ = 0;
    bool radial_;
};

} // namespace raywise::detail
