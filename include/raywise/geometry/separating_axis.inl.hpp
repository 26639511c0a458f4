// Bodies of the separating axis templates.
#pragma once

#include <raywise/core/rounding.hpp>
#include <raywise/geometry/convex_body.hpp>
#include <raywise/geometry/separating_axis.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

template <ConvexBody A, ConvexBody B>
bool separated_on(const A& a, const B& b, Vec3d axis) {
    // Twice the eight operations of a shadow, so that a point which `contains` grants a region by
    // rounding is never separated from it.
    constexpr double relative_slack = gamma_bound(16, double_epsilon);
    const Shadow on_a = a.shadow(axis);
    const Shadow on_b = b.shadow(axis);
    const double slack = relative_slack * dot(abs(axis), a.reach() + b.reach());
    return on_b.lo - on_a.hi > slack || on_a.lo - on_b.hi > slack;
}

template <ConvexBody A, ConvexBody B>
bool separated_by_face(const A& a, const B& b) {
    for (const Vec3d& normal : a.normals())
        if (separated_on(a, b, normal)) return true;
    for (const Vec3d& normal : b.normals())
        if (separated_on(a, b, normal)) return true;
    return false;
}

template <ConvexBody A, ConvexBody B>
bool separated_by_edges(const A& a, const B& b) {
    constexpr double parallel_sine_squared = 1e-12;
    for (const Vec3d& u : a.edges()) {
        for (const Vec3d& v : b.edges()) {
            const Vec3d axis = cross(u, v);
            if (dot(axis, axis) <= parallel_sine_squared * dot(u, u) * dot(v, v)) continue;
            if (separated_on(a, b, axis)) return true;
        }
    }
    return false;
}

} // namespace raywise
