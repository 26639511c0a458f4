// Parallel rays: one direction, optionally blurred to a cone, origins uniform on a rectangle (a
// sun, a distant lamp, an orthographic camera). After [Falcone24]; ours: the closed form behind one
// plane of clipping, the cone, the narrowed measure.
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace raywise {

/// The rectangle point + x right + y up, |x| <= half_width, |y| <= half_height, from which the rays
/// run along `frame.forward`.
struct ParallelParams {
    Vec3d point = {};               ///< center of the window, finite
    Frame frame = {};               ///< orthonormal, see frame_along
    double half_width = 1;          ///< along frame.right, scene units, > 0, finite
    double half_height = 1;         ///< along frame.up, scene units, > 0, finite
    double start_depth = 0;         ///< rays start this far along forward from `point`; finite
    double cone_half_angle_deg = 0; ///< directions are uniform per solid angle in the cone of this
                                    ///< half angle about forward, in [0, 60]; 0: exactly parallel
};

/// The map of space to window coordinates along one direction: window = [-1, 1]^2, depth >= 0 in
/// front of the window.
struct WindowProjection {
    Vec3d x_axis, y_axis, z_axis; ///< linear parts of the three coordinates
    Vec3d offset;                 ///< their constant parts

    [[nodiscard]] Vec3d operator()(Vec3d p) const {
        return {dot(x_axis, p) + offset.x, dot(y_axis, p) + offset.y, dot(z_axis, p) + offset.z};
    }
};

/// Probability that a ray meets a box: the area of the box's shadow on the window, over the window.
/// A box wholly behind the window has measure 0; one that crosses it counts with its part in front.
///
/// Without a cone it is exact up to rounding. With one it is the mean of 16 exact measures over
/// directions that split the cone into equal solid angles: the error is at most the variation of
/// the exact measure within one cell, that is, 0 for boxes whose every shadow lies in the window up
/// to the curvature of their area, and at most a sixteenth part per direction that the window's
/// border cuts wrongly.
///
/// Cost: closed form (as cheap as a surface area once `narrowed` to a box inside the window);
/// clipping only for boxes at the window's border. No allocation.
class ParallelMeasure {
public:
    explicit ParallelMeasure(const ParallelParams& params);

    [[nodiscard]] float operator()(const Aabb& box) const {
        if (box.is_empty()) return 0;
        const Vec3 s = box.size();
        const float unclipped =
            weights_.x * (s.y * s.z) + weights_.y * (s.x * s.z) + weights_.z * (s.x * s.y);
        if (inside_ || is_inside(box)) return std::min(unclipped, 1.0F);
        return clipped(box);
    }

    /// The same measure, cheaper for boxes inside `box`: when the shadow of `box` lies in the
    /// window, theirs need no test.
    [[nodiscard]] ParallelMeasure narrowed(const Aabb& box) const {
        ParallelMeasure result = *this;
        result.inside_ = inside_ || (!box.is_empty() && is_inside(box));
        return result;
    }

    /// Area of the whole shadow over the window's area, window border and window plane ignored; may
    /// exceed 1. The thesis's unculled measure.
    [[nodiscard]] double unculled(const Aabb& box) const;

    /// Probability that a ray meets both boxes: the common part of their shadows.
    [[nodiscard]] double shared(const Aabb& a, const Aabb& b) const;

    /// The same for whole shadows, as `unculled`.
    [[nodiscard]] double unculled_shared(const Aabb& a, const Aabb& b) const;

private:
    /// Whether every shadow of the box lies in the window, all of the box in front. Conservative
    /// for cones: the shadow is widened by the cone's spread over the box's depth.
    [[nodiscard]] bool is_inside(const Aabb& box) const {
        const Vec3d lo = to_double(box.lo);
        const Vec3d hi = to_double(box.hi);
        const Vec3d center = (lo + hi) * 0.5;
        const Vec3d half = (hi - lo) * 0.5;
        const Vec3d at = axis_(center);
        const double depth = dot(abs_z_, half);
        const double far = at.z + depth;
        return at.z - depth >= 0 && std::abs(at.x) + dot(abs_x_, half) + spread_x_ * far <= 1 &&
               std::abs(at.y) + dot(abs_y_, half) + spread_y_ * far <= 1;
    }

    [[nodiscard]] float clipped(const Aabb& box) const;

    WindowProjection axis_;
    Vec3d abs_x_, abs_y_, abs_z_;
    double spread_x_ = 0; // how far the cone carries a shadow per unit of depth, window units
    double spread_y_ = 0;
    Vec3 weights_; // of the three face areas, mean over the quadrature
    bool inside_ = false;
    std::shared_ptr<const std::vector<WindowProjection>> projections_;
};

/// Rays from the window, unit directions.
class ParallelDistribution {
public:
    /// Throws Error with the first parameter out of its range.
    explicit ParallelDistribution(const ParallelParams& params);

    [[nodiscard]] const ParallelParams& params() const { return params_; }

    [[nodiscard]] Ray sample(Rng& rng) const;

    /// Per unit of window area (and per steradian when there is a cone). 0 off the window or off
    /// the direction, both up to the rounding of a float ray.
    [[nodiscard]] double density(const Ray& ray) const;

    [[nodiscard]] ParallelMeasure measure() const { return ParallelMeasure(params_); }

    /// The window's forward direction, for every box.
    [[nodiscard]] Vec3d direction_at(const Aabb& box) const;

private:
    ParallelParams params_;
};

} // namespace raywise
