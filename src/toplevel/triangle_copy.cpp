#include <raywise/toplevel/triangle_copy.hpp>

namespace raywise {

TriangleCopy::TriangleCopy(const TriangleView& triangles) {
    reserve(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
        add(triangles[to_prim(i)]);
}

TriangleCopy::TriangleCopy(const TriangleView& triangles, std::span<const PrimId> members) {
    reserve(members.size());
    for (const PrimId member : members)
        add(triangles[member]);
}

void TriangleCopy::reserve(std::size_t count) {
    vertices_.reserve(3 * count);
    corners_.reserve(count);
}

void TriangleCopy::add(const Triangle& triangle) {
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    vertices_.insert(vertices_.end(), {triangle.v0, triangle.v1, triangle.v2});
    corners_.push_back({first, first + 1, first + 2});
}

} // namespace raywise
