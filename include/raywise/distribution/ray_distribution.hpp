// What every ray distribution offers: a sampler, its density and its hit measure, one family held
// together by one statistical test. [Falcone24]
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <concepts>
#include <cstdint>

namespace raywise {

/// A probability law over rays.
/// - `sample` draws a valid ray; the same generator state gives the same ray.
/// - `density` is the probability density at a ray, in the unit that each law states; 0 for a ray
///   that it never draws.
/// - `measure` is the probability, in [0, 1], that a drawn ray meets a box: absolute, that is, as a
///   share of all drawn rays.
/// - `direction_at` is the direction of the rays at a box, of any positive length; only the shares
///   of its components' magnitudes matter to an axis policy. [Falcone24]
template <class D>
concept RayDistribution =
    requires(const D& distribution, Rng& rng, const Ray& ray, const Aabb& box) {
        { distribution.sample(rng) } -> std::same_as<Ray>;
        { distribution.density(ray) } -> std::same_as<double>;
        { distribution.measure() } -> HitMeasure;
        { distribution.direction_at(box) } -> std::same_as<Vec3d>;
    };

/// Which measure a radial distribution answers with.
enum class MeasureMode : std::uint8_t {
    exact,  ///< the probability that a drawn ray meets the box
    thesis, ///< what [Falcone24] computes: the pinhole area whatever the emission, and 0 for a box
            ///< that holds the eye; neither monotone nor a probability, for faithful runs only
};

} // namespace raywise
