// Triangles of one's own, in the order of a list.
#pragma once

#include <raywise/core/ids.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raywise {

/// A copy of triangles that outlives the mesh they came from: 48 bytes each.
class TriangleCopy {
public:
    /// All of them.
    explicit TriangleCopy(const TriangleView& triangles);

    /// Those listed; triangle i of the copy is triangles[members[i]].
    TriangleCopy(const TriangleView& triangles, std::span<const PrimId> members);

    /// Valid as long as the copy stays where it is.
    [[nodiscard]] TriangleView view() const { return {vertices_, corners_}; }

    [[nodiscard]] std::size_t size_in_bytes() const {
        return vertices_.size() * sizeof(vertices_[0]) + corners_.size() * sizeof(corners_[0]);
    }

private:
    void reserve(std::size_t count);
    void add(const Triangle& triangle);

    std::vector<Vec3> vertices_;
    std::vector<std::array<std::uint32_t, 3>> corners_;
};

} // namespace raywise
