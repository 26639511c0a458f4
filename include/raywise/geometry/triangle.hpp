// A triangle by its vertices.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

/// Counter-clockwise seen from its front. Zero-area triangles are allowed and never hit.
struct Triangle {
    Vec3 v0;
    Vec3 v1;
    Vec3 v2;

    friend constexpr bool operator==(const Triangle&, const Triangle&) = default;
};

[[nodiscard]] constexpr Aabb bounds(const Triangle& triangle) {
    return {
        min(min(triangle.v0, triangle.v1), triangle.v2),
        max(max(triangle.v0, triangle.v1), triangle.v2)
    };
}

} // namespace raywise
