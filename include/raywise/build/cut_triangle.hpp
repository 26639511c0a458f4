// The boxes of the two parts of a triangle that a plane cuts, rounded so that no point is lost.
#pragma once

#include <raywise/build/prim_box.hpp>
#include <raywise/build/quad.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <array>

namespace raywise {

/// A triangle's vertices, one per register; the fourth lanes are 0, -0 is made +0.
using Corners = std::array<Quad, 3>;

[[nodiscard]] inline Corners corners_of(const TriangleView& triangles, PrimId id) {
    const Triangle t = triangles[id];
    const Quad zero = make_quad(0);
    return {
        Quad{t.v0.x, t.v0.y, t.v0.z, 0} + zero,
        Quad{t.v1.x, t.v1.y, t.v1.z, 0} + zero,
        Quad{t.v2.x, t.v2.y, t.v2.z, 0} + zero
    };
}

/// Where the edge from a to b meets the plane at `x` of the axis; a and b are on different sides
/// of it. Rounded.
[[nodiscard]] inline Quad cross_plane(Quad a, Quad b, int axis, float x) {
    return a + (b - a) * make_quad((x - a[axis]) / (b[axis] - a[axis]));
}

/// Both parts of a reference to a triangle. A part that is empty holds nothing of the triangle.
struct CutReference {
    PrimBox left;
    PrimBox right;

    [[nodiscard]] static bool is_empty(const PrimBox& part) {
        return !(part.lo[0] <= part.hi[0] && part.lo[1] <= part.hi[1] && part.lo[2] <= part.hi[2]);
    }
};

/// Cuts a reference, a triangle's part inside a box, by the plane at `x` of the axis, which must be
/// inside the box. Every point (of real coordinates) of the triangle in the box of `reference` is
/// in the box of a part on its side of the plane, or of both. Coordinates within [-2^60, 2^60].
[[nodiscard]] CutReference
cut_reference(const PrimBox& reference, const Corners& corners, int axis, float x);

} // namespace raywise
