#include <raywise/geometry/separating_axis.hpp>

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_body.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

namespace {

bool is_finite(const Triangle& triangle) {
    return raywise::is_finite(triangle.v0) && raywise::is_finite(triangle.v1) &&
           raywise::is_finite(triangle.v2);
}

} // namespace

// The world-aligned box goes first: its three normals are the test of the enclosing boxes.

bool overlaps(const Obb& obb, const Aabb& box) {
    return !box.is_empty() && overlaps(BoxBody(box), BoxBody(obb));
}

bool overlaps(const Frustum& frustum, const Aabb& box) {
    return !box.is_empty() && overlaps(BoxBody(box), FrustumBody(frustum));
}

bool overlaps(const Aabb& box, const Triangle& triangle) {
    return is_finite(triangle) && overlaps(box, bounds(triangle)) &&
           overlaps(BoxBody(box), TriangleBody(triangle));
}

bool overlaps(const Obb& obb, const Triangle& triangle) {
    return is_finite(triangle) && overlaps(BoxBody(obb), TriangleBody(triangle));
}

bool overlaps(const Frustum& frustum, const Triangle& triangle) {
    return is_finite(triangle) && overlaps(FrustumBody(frustum), TriangleBody(triangle));
}

} // namespace raywise
