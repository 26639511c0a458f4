// One picture of the world as a pencil sees it: the plane across parallel rays, or one face of the
// cube around an apex. Rays are points of the picture, triangles are triangles.
#pragma once

#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

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
    double tiny;  ///< such that the roundings of t and of depths are 2^-24 (depth + start + tiny)
};

class Face {
public:
    /// The only picture of a parallel pencil. Coordinates are relative to `origin`: the nearer to
    /// the scene, the more precise.
    static Face parallel(Vec3 direction, Vec3 origin, bool reversed) {
        const int z = dominant_axis(direction);
        Face face(origin, z, direction[z] < 0 ? -1 : 1, reversed);
        face.slope_x_ = difference(direction, face.x_, 0) / difference(direction, face.z_, 0);
        face.slope_y_ = difference(direction, face.y_, 0) / difference(direction, face.z_, 0);
        return face;
    }

    /// The face of the cube around the apex on side `index % 2` of axis `index / 2`.
    static Face radial(Vec3 apex, int index, bool reversed) {
        return {apex, index / 2, index % 2 == 0 ? 1 : -1, reversed};
    }

    [[nodiscard]] bool is_reversed() const { return depth_sign_ != sign_; }

    template <bool is_radial>
    [[nodiscard]] FacePoint point(const Vec3& p) const {
        const double x = difference(p, x_, origin_[0]);
        const double y = difference(p, y_, origin_[1]);
        const double along = difference(p, z_, origin_[2]);
        if constexpr (is_radial) {
            return {x, y, along * sign_, along * depth_sign_};
        } else {
            return {x - slope_x_ * along, y - slope_y_ * along, 1, along * depth_sign_};
        }
    }

    /// For a valid ray of the pencil that this face sees; `leaves`: it runs away from the emitter.
    template <bool is_radial>
    [[nodiscard]] FaceRay ray(const Ray& ray, bool leaves) const {
        const double speed = std::abs(difference(ray.direction, z_, 0));
        const auto t_min = static_cast<double>(ray.t_min);
        // Hits at an infinite t do not count, and a denormal direction gets there.
        const auto t_max =
            static_cast<double>(std::min(ray.t_max, std::numeric_limits<float>::max()));
        const FacePoint from = point<is_radial>(ray.origin);
        FaceRay seen{};
        if (!is_radial) {
            seen.u = from.x;
            seen.v = from.y;
        } else if (leaves) {
            const double inverse = 1 / speed;
            seen.u = difference(ray.direction, x_, 0) * inverse;
            seen.v = difference(ray.direction, y_, 0) * inverse;
        } else {
            const double inverse = 1 / from.h;
            seen.u = from.x * inverse;
            seen.v = from.y * inverse;
        }
        seen.start = from.depth;
        // A float direction passes the apex by a rounding, and a tiny negative t is rounded to 0.
        seen.brink = 8 * 0x1p-24 * std::abs(from.depth) + 0x1p-148 * speed;
        // Denormal t and depths have fewer bits.
        seen.tiny = 0x1p-124 * speed + 0x1p-120;
        const bool forward = leaves != is_reversed();
        seen.near = from.depth + (forward ? t_min : -t_max) * speed;
        seen.far = from.depth + (forward ? t_max : -t_min) * speed;
        return seen;
    }

    /// The depth of a ray's point at t.
    [[nodiscard]] double depth_at(const Ray& ray, float t) const {
        return (difference(ray.origin, z_, origin_[2]) +
                difference(ray.direction, z_, 0) * static_cast<double>(t)) *
               depth_sign_;
    }

    /// The face of the cube that sees a ray of a radial pencil.
    [[nodiscard]] static std::size_t index_of(Vec3 apex, const Ray& ray, bool leaves) {
        const Vec3d d = leaves ? to_double(ray.direction) : to_double(ray.origin) - to_double(apex);
        const int axis = dominant_axis(d);
        return 2 * static_cast<std::size_t>(axis) + (d[axis] < 0 ? 1 : 0);
    }

private:
    Face(Vec3 origin, int z, int sign, bool reversed)
        : x_(offset((z + 1) % 3))
        , y_(offset((z + 2) % 3))
        , z_(offset(z))
        , origin_{static_cast<double>(origin[(z + 1) % 3]), static_cast<double>(origin[(z + 2) % 3]), static_cast<double>(origin[z])}
        , sign_(sign)
        , depth_sign_(reversed ? -sign : sign) {}

    static std::size_t offset(int axis) { return static_cast<std::size_t>(axis) * sizeof(float); }

    static double difference(const Vec3& p, std::size_t offset, double from) {
        float x = 0;
        std::memcpy(&x, reinterpret_cast<const std::byte*>(&p) + offset, sizeof x);
        return static_cast<double>(x) - from;
    }

    std::size_t x_, y_, z_;        ///< byte offsets of the axes
    std::array<double, 3> origin_; ///< along them
    double sign_;
    double depth_sign_;
    double slope_x_ = 0;
    double slope_y_ = 0;
};

} // namespace raywise::detail
