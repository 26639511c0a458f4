// A caller's mesh, read in place: vertices and indices with strides of their own.
#pragma once

#include <raywise/core/ids.hpp>
#include <raywise/geometry/triangle.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace raywise {

/// Indexed triangles in memory that somebody else owns; nothing is copied. Positions are three
/// floats, corners three 32-bit indices, each at its own byte stride. The caller vouches that every
/// index is below the number of vertices
/// (`scene` and `io` check theirs).
class TriangleView {
public:
    TriangleView() = default;

    TriangleView(
        std::span<const Vec3> vertices,
        std::span<const std::array<std::uint32_t, 3>> corners
    )
        : vertices_(reinterpret_cast<const std::byte*>(vertices.data()))
        , corners_(reinterpret_cast<const std::byte*>(corners.data()))
        , count_(corners.size()) {}

    TriangleView(
        const float* positions,
        std::size_t position_stride,
        const std::uint32_t* corners,
        std::size_t corner_stride,
        std::size_t triangle_count
    )
        : vertices_(reinterpret_cast<const std::byte*>(positions))
        , corners_(reinterpret_cast<const std::byte*>(corners))
        , vertex_stride_(position_stride)
        , corner_stride_(corner_stride)
        , count_(triangle_count) {}

    [[nodiscard]] std::size_t size() const { return count_; }

    [[nodiscard]] Triangle operator[](PrimId id) const {
        std::array<std::uint32_t, 3> corner{};
        std::memcpy(corner.data(), corners_ + to_index(id) * corner_stride_, sizeof corner);
        return {vertex(corner[0]), vertex(corner[1]), vertex(corner[2])};
    }

private:
    [[nodiscard]] Vec3 vertex(std::uint32_t index) const {
        Vec3 position;
        std::memcpy(&position, vertices_ + index * vertex_stride_, sizeof position);
        return position;
    }

    const std::byte* vertices_ = nullptr;
    const std::byte* corners_ = nullptr;
    std::size_t vertex_stride_ = sizeof(Vec3);
    std::size_t corner_stride_ = 3 * sizeof(std::uint32_t);
    std::size_t count_ = 0;
};

} // namespace raywise
