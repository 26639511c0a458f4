// Whether two convex bodies overlap: they are disjoint exactly when their shadows are on a face
// normal of one or on a cross product of their edges. After [Gottschalk96].
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_body.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/triangle.hpp>

namespace raywise {

/// Whether the shadows on `axis` are certainly disjoint: the gap exceeds what rounding can feign.
template <ConvexBody A, ConvexBody B>
[[nodiscard]] bool separated_on(const A& a, const B& b, Vec3d axis);

/// Whether a face normal of either body separates them: quick, but not complete.
template <ConvexBody A, ConvexBody B>
[[nodiscard]] bool separated_by_face(const A& a, const B& b);

/// Whether a cross product of an edge of each separates them. Nearly parallel edges are skipped:
/// their cross product is rounding noise.
template <ConvexBody A, ConvexBody B>
[[nodiscard]] bool separated_by_edges(const A& a, const B& b);

/// Whether the closed bodies share a point. Conservative: may say yes wrongly (by rounding), never
/// no. Faces first, those of `a` before those of `b`: pass the body with the cheapest rejections
/// first.
template <ConvexBody A, ConvexBody B>
[[nodiscard]] bool overlaps(const A& a, const B& b) {
    return !separated_by_face(a, b) && !separated_by_edges(a, b);
}

/// Conservative as the general form; false for an empty box and for a triangle that is not finite.
/// 15, 26, 13, 13 and 24 axes.
[[nodiscard]] bool overlaps(const Obb& obb, const Aabb& box);
[[nodiscard]] bool overlaps(const Frustum& frustum, const Aabb& box);
[[nodiscard]] bool overlaps(const Aabb& box, const Triangle& triangle);
[[nodiscard]] bool overlaps(const Obb& obb, const Triangle& triangle);
[[nodiscard]] bool overlaps(const Frustum& frustum, const Triangle& triangle);

} // namespace raywise

#include <raywise/geometry/separating_axis.inl.hpp> // IWYU pragma: export
