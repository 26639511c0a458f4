// Triangles of one's own: a part of a mesh, a mesh in other coordinates, or one that must outlive
// its owner.
#pragma once

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise {

/// Triangles that share no vertices: 48 bytes each.
struct TriangleCopy {
    std::vector<Vec3> vertices; ///< three for each triangle
    std::vector<std::array<std::uint32_t, 3>> corners;

    /// Valid until the vectors change.
    [[nodiscard]] TriangleView view() const { return {vertices, corners}; }

    [[nodiscard]] std::size_t size_in_bytes() const {
        return vertices.size() * sizeof(vertices[0]) + corners.size() * sizeof(corners[0]);
    }
};

/// Triangle i of the result is `triangle_of(i)`, which is called once for each, from any thread. At
/// most 2^32 / 3 triangles; throws Error above.
template <class TriangleOf>
[[nodiscard]] TriangleCopy copy_triangles(
    std::size_t count,
    const TriangleOf& triangle_of,
    const Executor& executor = serial_executor()
) {
    if (count > 0xFFFFFFFFU / 3) throw Error("triangles: too many to copy");
    TriangleCopy copy;
    copy.vertices.resize(3 * count);
    copy.corners.resize(count);
    constexpr std::size_t chunk = 8192;
    executor.for_each_chunk(count, chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Triangle triangle = triangle_of(i);
            copy.vertices[3 * i] = triangle.v0;
            copy.vertices[3 * i + 1] = triangle.v1;
            copy.vertices[3 * i + 2] = triangle.v2;
            const auto first = static_cast<std::uint32_t>(3 * i);
            copy.corners[i] = {first, first + 1, first + 2};
        }
    });
    return copy;
}

} // namespace raywise
