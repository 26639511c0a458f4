// Radial rays: through one eye, in a rectangular window or in all directions (a camera, a lamp, a
// scanner). After [Falcone24]; ours: a measure for each emission, exact clipping as cones through
// the eye, emitters with a radius.
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/distribution/ray_distribution.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/projected_area.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/solid_angle.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace raywise {

/// How directions spread over the window. Densities are with respect to (x, y) on the plane at
/// distance 1.
enum class Emission : std::uint8_t {
    pinhole,   ///< uniform on the plane (a camera); needs a window
    isotropic, ///< uniform per solid angle, (1 + x^2 + y^2)^(-3/2) (a point light, a scanner)
    yaw_pitch, ///< yaw and pitch uniform within half the fields of view; needs a window. The rays
               ///< of [Falcone24]; some leave the window above and below
};

/// The directions x right + y up + forward with |x| <= tan_x, |y| <= tan_y.
struct RadialWindow {
    double tan_x = 1; ///< tangent of half the horizontal field of view, > 0, finite
    double tan_y = 1; ///< of half the vertical one
};

/// The window of two full fields of view, degrees, in (0, 180); throws Error otherwise.
[[nodiscard]] RadialWindow window_of_fov(double fov_x_deg, double fov_y_deg);

struct RadialParams {
    Vec3d eye = {};                          ///< finite
    Frame frame = {};                        ///< orthonormal, see frame_along
    std::optional<RadialWindow> window = {}; ///< nullopt: all directions (isotropic only)
    Emission emission = Emission::pinhole;
    double start_depth = 0; ///< rays start at this depth along forward; 0: at the eye; >= 0,
                            ///< finite; 0 when there is no window
    double radius = 0; ///< the emitter is shifted by a vector uniform in the ball of this radius,
                       ///< scene units, >= 0, finite
};

/// Probability that a ray meets a box: the share of the emission that the box covers as seen from
/// the eye, clipped to the window and to the depth at which rays start. Rays that start inside the
/// box meet it: 1 for a box that holds the eye, when they start at the eye.
///
/// Exact up to rounding, yaw_pitch by quadrature along the silhouette's edges (see
/// YawPitchProjection). With a radius it is the mean over 13 positions of the eye, a formula of
/// degree 5 for the ball: the error is a fifth-order term of radius over distance for boxes farther
/// away than a few radii, and at most the weight of one position (0.07; 0.16 for the center) for
/// each that a border of the box or of the window judges wrongly.
///
/// Cost: a closed form for pinhole and isotropic boxes inside the window (best `narrowed` to one),
/// clipping at its border, a quadrature for each edge for yaw_pitch. No allocation.
class RadialMeasure {
public:
    /// `params` as RadialDistribution requires them; throws Error otherwise.
    explicit RadialMeasure(const RadialParams& params, MeasureMode mode = MeasureMode::exact);

    [[nodiscard]] float operator()(const Aabb& box) const;

    /// The same measure, cheaper for boxes inside `box`: when `box` lies in the window's pyramid,
    /// they need no test.
    [[nodiscard]] RadialMeasure narrowed(const Aabb& box) const;

    /// Probability that a pinhole's ray meets both boxes, whatever the emission: the common part of
    /// their shadows on the window. nullopt when there is no window. The radius is ignored.
    [[nodiscard]] std::optional<double> shared(const Aabb& a, const Aabb& b) const;

    /// Area of the whole shadow over the window's area, window border, start depth and radius
    /// ignored; may exceed 1; +inf when the box reaches the plane of the eye. Without a window: the
    /// solid angle over 4 pi. The thesis's unculled measure.
    [[nodiscard]] double unculled(const Aabb& box) const;

    /// The common part of two whole shadows, as `unculled`; nullopt when there is no window or a
    /// box reaches the plane of the eye.
    [[nodiscard]] std::optional<double> unculled_shared(const Aabb& a, const Aabb& b) const;

private:
    /// The emission all around a point.
    struct AllAround {
        Vec3d eye;

        [[nodiscard]] double operator()(const Aabb& box) const;
    };

    /// What one position of the eye sees, and its weight in the mean.
    struct Sight {
        std::variant<PerspectiveProjection, SolidAngleProjection, YawPitchProjection, AllAround>
            share;
        double weight;
    };

    [[nodiscard]] static Sight
    sight_from(const RadialParams& params, Vec3d shift, double weight, MeasureMode mode);

    [[nodiscard]] double inside_share(const Aabb& box) const;

    Vec3d eye_;
    MeasureMode mode_;
    Emission weighing_;                   // of the shadow: pinhole in the thesis's mode
    std::optional<PerspectiveView> view_; // nullopt: no window
    double window_sr_ = 0;
    bool inside_ = false; // whether every box asked for lies in the window's pyramid
    std::shared_ptr<const std::vector<Sight>> sights_;
};

/// Rays from the eye (or from the plane at the start depth) into the window, unit directions.
class RadialDistribution {
public:
    /// Throws Error with the first parameter out of its range.
    explicit RadialDistribution(const RadialParams& params);

    [[nodiscard]] const RadialParams& params() const { return params_; }

    [[nodiscard]] Ray sample(Rng& rng) const;

    /// Per steradian of the direction, whatever the origin.
    [[nodiscard]] double density(const Ray& ray) const;

    [[nodiscard]] RadialMeasure measure(MeasureMode mode = MeasureMode::exact) const {
        return RadialMeasure(params_, mode);
    }

    /// From the eye to the center of the box; forward when they coincide.
    [[nodiscard]] Vec3d direction_at(const Aabb& box) const;

private:
    RadialParams params_;
};

} // namespace raywise
