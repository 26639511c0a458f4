// Triangles drawn over rays.
#pragma once

#include "pencil/inversion/ray_tiles.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/pencil/pencil.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace raywise::detail {

/// One batch being answered. Safe to use from several threads: tiles are locked.
struct Raster {
    const TriangleView& triangles;
    const Pencil& pencil;
    std::span<const Ray> rays;
    RayTiles& tiles;
    bool* hits;     ///< by ray; null: the closest hits are wanted
    bool is_shared; ///< whether several threads draw
};

/// Draws the triangles [first, last). Any hits: sets `hits`. Closest hits: updates `tiles.best`.
/// The result does not depend on the order of triangles.
void draw(const Raster& raster, std::size_t first, std::size_t last);

} // namespace raywise::detail
