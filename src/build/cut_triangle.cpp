#include <raywise/build/cut_triangle.hpp>

#include <raywise/build/prim_box.hpp>
#include <raywise/build/quad.hpp>

#include <cstddef>

namespace raywise {

namespace {

Quad magnitude(Quad a) {
    return max(a, -a);
}

/// A box that holds the exact crossing of an edge with the plane; a is below, b above it.
///
/// Why: with u = 2^-24, the parameter carries three roundings and the difference b - a one, so
/// their product is off by at most 5.1 u |b - a| + 2^-149, the sum by u |p|, and the widened corner
/// by u (|p| + margin). 8 u |b - a| + 4 u |p| + 2^-140 are granted.
QuadBox bound_crossing(Quad a, Quad b, int axis, float x) {
    const Quad p = cross_plane(a, b, axis, x);
    const Quad margin =
        magnitude(b - a) * 0x1p-21F + magnitude(p) * 0x1p-22F + make_quad(0x1p-140F);
    return {p - margin, p + margin};
}

PrimBox part_of(const PrimBox& reference, const QuadBox& hull) {
    PrimBox part{max(reference.lo, hull.lo), min(reference.hi, hull.hi)};
    part.lo[3] = reference.lo[3];
    part.hi[3] = reference.hi[3];
    return part;
}

} // namespace

CutReference cut_reference(const PrimBox& reference, const Corners& corners, int axis, float x) {
    // The part of the triangle on a side is the hull of the vertices there and of the crossings.
    QuadBox left;
    QuadBox right;
    for (std::size_t i = 0; i < 3; ++i) {
        const Quad a = corners[i];
        const Quad b = corners[(i + 1) % 3];
        if (a[axis] <= x) left.unite(a);
        if (a[axis] >= x) right.unite(a);
        if ((a[axis] < x && b[axis] > x) || (a[axis] > x && b[axis] < x)) {
            const QuadBox crossing =
                a[axis] < b[axis] ? bound_crossing(a, b, axis, x) : bound_crossing(b, a, axis, x);
            left.unite(crossing);
            right.unite(crossing);
        }
    }
    left.hi[axis] = left.hi[axis] < x ? left.hi[axis] : x;
    right.lo[axis] = right.lo[axis] > x ? right.lo[axis] : x;
    return {part_of(reference, left), part_of(reference, right)};
}

} // namespace raywise
