// Convex regions of space: the box, the oriented box and the frustum behind one set of questions.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle.hpp>

#include <variant>

namespace raywise {

/// A convex closed set.
using Region = std::variant<Aabb, Obb, Frustum>;

/// Whether the point is in the closed set. Rounding: in case of doubt it is, so every point of the
/// set is accepted, and points outside it by a few units in the last place of the (double) operands
/// may be.
[[nodiscard]] bool contains(const Region& region, Vec3d point);

/// Whether the whole box is in the region: its eight vertices are. False for an empty box.
[[nodiscard]] bool contains(const Region& region, const Aabb& box);

/// Whether region and box share a point. Conservative: may say yes wrongly (by rounding), never no.
/// False for an empty box.
[[nodiscard]] bool overlaps(const Region& region, const Aabb& box);

/// Whether region and triangle share a point. Conservative like the box form. Triangles with NaN
/// overlap nothing.
[[nodiscard]] bool overlaps(const Region& region, const Triangle& triangle);

/// Parameter at which a ray that starts inside leaves the region, rounded down; >= 0; +inf if it
/// never leaves. For an origin outside the result is meaningless: ask `contains` first.
[[nodiscard]] float exit_parameter(const Region& region, const Ray& ray);

/// A float box that encloses the region (rounded outward), at most two units in the last place
/// larger than the smallest. Every float point that `contains` accepts is in it.
[[nodiscard]] Aabb bounds(const Region& region);

/// Length of the longest diagonal.
[[nodiscard]] double diameter(const Region& region);

/// In scene units cubed.
[[nodiscard]] double volume(const Region& region);

/// A region of the same kind that contains every point within `margin` (>= 0, scene units) of the
/// region.
[[nodiscard]] Region inflated(const Region& region, double margin);

} // namespace raywise
