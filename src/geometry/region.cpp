#include <raywise/geometry/region.hpp>

#include "geometry/exit_bound.hpp"
#include "geometry/round_outward.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rounding.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/separating_axis.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>
#include <variant>

namespace raywise {

namespace {

float exit_parameter(const Aabb& box, const Ray& ray) {
    const Vec3d origin = to_double(ray.origin);
    const Vec3d direction = to_double(ray.direction);
    const Vec3d to_lo = origin - to_double(box.lo);
    const Vec3d to_hi = to_double(box.hi) - origin;
    ExitBound bound;
    for (int axis = 0; axis < 3; ++axis) {
        bound.add(to_lo[axis], 0, direction[axis], 0);
        bound.add(to_hi[axis], 0, -direction[axis], 0);
    }
    return bound.parameter();
}

double diameter_of(const Aabb& box) {
    return box.is_empty() ? 0 : length(to_double(box.hi) - to_double(box.lo));
}

double diameter_of(const Obb& obb) {
    return 2 * length(obb.half);
}

double diameter_of(const Frustum& frustum) {
    // The far face's diagonal, or from a near corner to the opposite far corner.
    const double across = std::hypot(frustum.tan_x, frustum.tan_y);
    return std::max(
        2 * frustum.far * across,
        std::hypot((frustum.near + frustum.far) * across, frustum.far - frustum.near)
    );
}

double volume_of(const Aabb& box) {
    if (box.is_empty()) return 0;
    const Vec3d size = to_double(box.hi) - to_double(box.lo);
    return size.x * size.y * size.z;
}

double volume_of(const Obb& obb) {
    return 8 * obb.half.x * obb.half.y * obb.half.z;
}

double volume_of(const Frustum& frustum) {
    const double n = frustum.near;
    const double f = frustum.far;
    return 4.0 / 3.0 * frustum.tan_x * frustum.tan_y * (f - n) * (f * f + f * n + n * n);
}

Region inflate(const Aabb& box, double margin) {
    if (box.is_empty()) return box;
    Aabb grown;
    for (int axis = 0; axis < 3; ++axis) {
        TrackedSum lo(to_double(box.lo)[axis]);
        TrackedSum hi(to_double(box.hi)[axis]);
        lo.add(-1, margin);
        hi.add(1, margin);
        grown.lo[axis] = lo.below();
        grown.hi[axis] = hi.above();
    }
    return grown;
}

/// A little more than the margin, for the rounding of coordinates as large as `reach`.
double widened(double margin, double reach) {
    return margin + gamma_bound(16, double_epsilon) * (margin + reach);
}

double largest_component(Vec3d v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

Region inflate(Obb obb, double margin) {
    const double grown =
        widened(margin, largest_component(obb.center) + largest_component(obb.half));
    obb.half = obb.half + Vec3d{grown, grown, grown};
    return obb;
}

// All six planes move outward by the margin. The fields of view stay; the eye moves back by as much
// as the wider of the two pairs of side planes needs: s sin(half angle) >= margin. From the new eye
// the near plane is then s - margin >= 0 deeper, so the apex never passes it.
Region inflate(Frustum frustum, double margin) {
    const double span = frustum.far * (1 + frustum.tan_x + frustum.tan_y);
    const double grown = widened(margin, largest_component(frustum.eye) + span);
    const auto one_over_sine = [](double tangent) { return std::hypot(1.0, tangent) / tangent; };
    const double back =
        grown * std::max(one_over_sine(frustum.tan_x), one_over_sine(frustum.tan_y));
    frustum.eye = frustum.eye - frustum.frame.forward * back;
    frustum.near = std::max(0.0, frustum.near + (back - grown));
    frustum.far = frustum.far + (back + grown);
    return frustum;
}

} // namespace

bool contains(const Region& region, Vec3d point) {
    return std::visit([&](const auto& kind) { return contains(kind, point); }, region);
}

bool contains(const Region& region, const Aabb& box) {
    return std::visit([&](const auto& kind) { return contains(kind, box); }, region);
}

bool overlaps(const Region& region, const Aabb& box) {
    return std::visit([&](const auto& kind) { return overlaps(kind, box); }, region);
}

bool overlaps(const Region& region, const Triangle& triangle) {
    return std::visit([&](const auto& kind) { return overlaps(kind, triangle); }, region);
}

float exit_parameter(const Region& region, const Ray& ray) {
    return std::visit([&](const auto& kind) { return exit_parameter(kind, ray); }, region);
}

Aabb bounds(const Region& region) {
    struct Bounds {
        Aabb operator()(const Aabb& box) const { return box; }

        Aabb operator()(const Obb& obb) const { return bounds(obb); }

        Aabb operator()(const Frustum& frustum) const { return bounds(frustum); }
    };

    return std::visit(Bounds{}, region);
}

double diameter(const Region& region) {
    return std::visit([](const auto& kind) { return diameter_of(kind); }, region);
}

double volume(const Region& region) {
    return std::visit([](const auto& kind) { return volume_of(kind); }, region);
}

Region inflated(const Region& region, double margin) {
    if (!(margin >= 0) || !std::isfinite(margin))
        throw Error("the margin of a region must be finite and not negative");
    if (margin == 0) return region;
    return std::visit([&](const auto& kind) { return inflate(kind, margin); }, region);
}

} // namespace raywise
