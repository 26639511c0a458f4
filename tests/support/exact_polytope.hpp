// Convex polytopes in rational numbers, and whether two of them share a point: the oracle of the
// separating axis test. It knows no axes: two polytopes meet exactly when an edge of one meets the
// other, and an edge meets a polytope when the half-spaces leave something of it.
#pragma once

#include "support/rational3.hpp"

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <gmpxx.h>

#include <utility>
#include <vector>

namespace raywise::oracle {

inline Rational3 exact(Vec3d a) {
    return {mpq_class(a.x), mpq_class(a.y), mpq_class(a.z)};
}

inline Rational3 plus(const Rational3& a, const Rational3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}

inline Rational3 times(const Rational3& a, const mpq_class& s) {
    return {a.x * s, a.y * s, a.z * s};
}

/// normal . p + offset >= 0.
struct HalfSpace {
    Rational3 normal;
    mpq_class offset;
};

/// The half-space whose border passes through `point`.
inline HalfSpace half_space(const Rational3& normal, const Rational3& point) {
    return {normal, -dot(normal, point)};
}

struct Polytope {
    std::vector<std::pair<Rational3, Rational3>> edges;
    std::vector<HalfSpace> half_spaces;
};

/// Edges between vertices that differ in one bit of their number.
inline void add_box_edges(Polytope& body, const std::vector<Rational3>& vertices) {
    for (unsigned i = 0; i < 8; ++i)
        for (const unsigned bit : {1U, 2U, 4U})
            if ((i & bit) == 0) body.edges.emplace_back(vertices[i], vertices[i | bit]);
}

inline Polytope
parallelepiped(const Rational3& center, const Rational3 (&axes)[3], const Rational3& half) {
    Polytope body;
    std::vector<Rational3> vertices;
    for (unsigned i = 0; i < 8; ++i) {
        Rational3 at = center;
        at = plus(at, times(axes[0], (i & 4U) != 0 ? half.x : mpq_class(-half.x)));
        at = plus(at, times(axes[1], (i & 2U) != 0 ? half.y : mpq_class(-half.y)));
        at = plus(at, times(axes[2], (i & 1U) != 0 ? half.z : mpq_class(-half.z)));
        vertices.push_back(at);
    }
    add_box_edges(body, vertices);
    for (unsigned k = 0; k < 3; ++k) {
        const Rational3 normal = cross(axes[(k + 1) % 3], axes[(k + 2) % 3]);
        body.half_spaces.push_back(half_space(normal, vertices[0]));
        body.half_spaces.push_back(half_space(times(normal, -1), vertices[7]));
    }
    return body;
}

inline Polytope polytope(const Obb& obb) {
    const Rational3 axes[3] = {
        exact(obb.frame.right), exact(obb.frame.up), exact(obb.frame.forward)
    };
    return parallelepiped(exact(obb.center), axes, exact(obb.half));
}

inline Polytope polytope(const Aabb& box) {
    const Rational3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const mpq_class half(1, 2);
    const Rational3 center = times(plus(exact(box.lo), exact(box.hi)), half);
    return parallelepiped(center, axes, times(minus(exact(box.hi), exact(box.lo)), half));
}

inline Polytope polytope(const Frustum& frustum) {
    const Rational3 eye = exact(frustum.eye);
    const Rational3 forward = exact(frustum.frame.forward);
    const Rational3 right = times(exact(frustum.frame.right), mpq_class(frustum.tan_x));
    const Rational3 up = times(exact(frustum.frame.up), mpq_class(frustum.tan_y));
    std::vector<Rational3> vertices;
    for (unsigned i = 0; i < 8; ++i) {
        Rational3 ray = plus(forward, times(right, (i & 4U) != 0 ? 1 : -1));
        ray = plus(ray, times(up, (i & 2U) != 0 ? 1 : -1));
        vertices.push_back(
            plus(eye, times(ray, mpq_class((i & 1U) != 0 ? frustum.far : frustum.near)))
        );
    }
    Polytope body;
    add_box_edges(body, vertices);
    const Rational3 along = cross(right, up);
    body.half_spaces.push_back(half_space(along, vertices[0]));
    body.half_spaces.push_back(half_space(times(along, -1), vertices[1]));
    for (const int side : {-1, 1}) {
        for (const bool horizontal : {true, false}) {
            const Rational3& across = horizontal ? right : up;
            const Rational3& other = horizontal ? up : right;
            Rational3 normal = cross(plus(forward, times(across, side)), other);
            if (dot(normal, forward) < 0) normal = times(normal, -1);
            body.half_spaces.push_back(half_space(normal, eye));
        }
    }
    return body;
}

inline Polytope polytope(const Triangle& triangle) {
    const Rational3 vertices[3] = {exact(triangle.v0), exact(triangle.v1), exact(triangle.v2)};
    const Rational3 normal =
        cross(minus(vertices[1], vertices[0]), minus(vertices[2], vertices[0]));
    Polytope body;
    body.half_spaces.push_back(half_space(normal, vertices[0]));
    body.half_spaces.push_back(half_space(times(normal, -1), vertices[0]));
    for (unsigned i = 0; i < 3; ++i) {
        const Rational3& from = vertices[i];
        const Rational3& to = vertices[(i + 1) % 3];
        body.edges.emplace_back(from, to);
        body.half_spaces.push_back(half_space(cross(normal, minus(to, from)), from));
    }
    return body;
}

inline bool meets(const std::pair<Rational3, Rational3>& edge, const Polytope& body) {
    mpq_class first = 0;
    mpq_class last = 1;
    for (const HalfSpace& half : body.half_spaces) {
        const mpq_class a = dot(half.normal, edge.first) + half.offset;
        const mpq_class b = dot(half.normal, edge.second) + half.offset;
        if (a < 0 && b < 0) return false;
        if (a < 0) first = std::max(first, mpq_class(a / (a - b)));
        if (b < 0) last = std::min(last, mpq_class(a / (a - b)));
    }
    return first <= last;
}

/// Exact, for bodies whose half-spaces are not degenerate.
inline bool overlap(const Polytope& a, const Polytope& b) {
    for (const auto& edge : a.edges)
        if (meets(edge, b)) return true;
    for (const auto& edge : b.edges)
        if (meets(edge, a)) return true;
    return false;
}

} // namespace raywise::oracle
