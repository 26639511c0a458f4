// Uniform lines: every position and direction alike, which is what the surface area heuristic
// assumes. After [Goldsmith87], [Santalo04].
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>

namespace raywise {

/// Probability that a uniform line through `bounds`, cut to the chord inside it, meets a box: the
/// surface area of their common part over that of `bounds`.
class UniformMeasure {
public:
    /// `bounds` as UniformDistribution requires it.
    explicit UniformMeasure(const Aabb& bounds) : bounds_(bounds), scale_(1 / half_area(bounds)) {}

    [[nodiscard]] float operator()(const Aabb& box) const {
        return std::min(1.0F, half_area(intersect(box, bounds_)) * scale_);
    }

private:
    Aabb bounds_;
    float scale_;
};

/// Isotropic lines through a box, each cut to its chord: the ray starts where the line enters the
/// box and ends where it leaves.
class UniformDistribution {
public:
    /// `bounds` finite, not empty, with positive surface area (a flat box is allowed); throws Error
    /// otherwise.
    explicit UniformDistribution(const Aabb& bounds);

    [[nodiscard]] const Aabb& bounds() const { return bounds_; }

    /// A chord, of unit direction.
    [[nodiscard]] Ray sample(Rng& rng) const;

    /// Per unit of area across the ray and per steradian: 1 / (pi surface area) for every line that
    /// meets the box, 0 for the others.
    [[nodiscard]] double density(const Ray& ray) const;

    [[nodiscard]] UniformMeasure measure() const { return UniformMeasure(bounds_); }

    /// Uniform lines face all axes alike: (1, 1, 1).
    [[nodiscard]] Vec3d direction_at(const Aabb& box) const;

private:
    Aabb bounds_;
};

} // namespace raywise
