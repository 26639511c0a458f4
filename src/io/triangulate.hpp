// Cuts polygons into triangles by ear clipping, in the plane of their Newell normal. After
// [Meisters75], [Sutherland74].
#pragma once

#include <raywise/geometry/vec.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace raywise::io_detail {

/// Appends corners.size() - 2 triangles (none for fewer than three corners) that keep the polygon's
/// turning sense. A simple planar polygon is covered exactly, concave ones included; one that
/// crosses itself, or is flat, is cut in some fixed way. O(n^2) for n corners, O(n) for a convex
/// polygon.
void triangulate(
    std::span<const Vec3> vertices,
    std::span<const std::uint32_t> corners,
    std::vector<std::array<std::uint32_t, 3>>& triangles
);

} // namespace raywise::io_detail
