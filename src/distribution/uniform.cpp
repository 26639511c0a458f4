#include <raywise/distribution/uniform.hpp>

#include "distribution/checks.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_box.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace raywise {

namespace {

/// The axis across a face drawn by area.
int draw_face_axis(const Aabb& box, Rng& rng) {
    const Vec3d s = to_double(box.hi) - to_double(box.lo);
    const std::array areas{s.y * s.z, s.x * s.z, s.x * s.y};
    const double at = rng.uniform_double() * (areas[0] + areas[1] + areas[2]);
    if (at < areas[0]) return 0;
    return at < areas[0] + areas[1] || areas[2] == 0 ? 1 : 2;
}

/// Cosine-distributed about the inward normal of a face: a point of the disk, lifted to the
/// hemisphere.
Vec3d draw_inward(int axis, bool low_face, Rng& rng) {
    const double radius = std::sqrt(rng.uniform_double());
    const double turn = 2 * std::numbers::pi * rng.uniform_double();
    const double height = std::sqrt(1 - radius * radius);
    Vec3d direction;
    direction[axis] = low_face ? height : -height;
    direction[(axis + 1) % 3] = radius * std::cos(turn);
    direction[(axis + 2) % 3] = radius * std::sin(turn);
    return direction;
}

/// Where a ray that starts in the box leaves it, rounded up.
float exit_of(const Aabb& box, Vec3 origin, Vec3 direction) {
    double exit = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0) continue;
        const float wall = direction[axis] > 0 ? box.hi[axis] : box.lo[axis];
        const double gap = static_cast<double>(wall) - static_cast<double>(origin[axis]);
        exit = std::min(exit, gap / static_cast<double>(direction[axis]));
    }
    return std::nextafter(static_cast<float>(exit), std::numeric_limits<float>::infinity());
}

} // namespace

UniformDistribution::UniformDistribution(const Aabb& bounds) : bounds_(bounds) {
    require_surface(bounds, "the bounds of uniform lines");
}

Ray UniformDistribution::sample(Rng& rng) const {
    const int axis = draw_face_axis(bounds_, rng);
    const bool low_face = (rng.bits() >> 63U) == 0;
    Vec3 origin;
    for (int k = 0; k < 3; ++k) {
        const auto drawn = static_cast<float>(
            rng.uniform(static_cast<double>(bounds_.lo[k]), static_cast<double>(bounds_.hi[k]))
        );
        origin[k] = std::clamp(drawn, bounds_.lo[k], bounds_.hi[k]);
    }
    origin[axis] = low_face ? bounds_.lo[axis] : bounds_.hi[axis];
    const Vec3 direction = to_float(draw_inward(axis, low_face, rng));
    return {.origin = origin, .direction = direction, .t_max = exit_of(bounds_, origin, direction)};
}

double UniformDistribution::density(const Ray& ray) const {
    if (!is_valid(ray) || !intersect(ray, bounds_)) return 0;
    return 1 / (2 * std::numbers::pi * static_cast<double>(half_area(bounds_)));
}

// NOLINTNEXTLINE(*-to-static): a member of every distribution
Vec3d UniformDistribution::direction_at(const Aabb&) const {
    return {1, 1, 1};
}

} // namespace raywise
