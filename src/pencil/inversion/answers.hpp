// What the rays of a batch were found to hit, slot by slot. A slot that is decided has near > far.
#pragma once

#include "pencil/inversion/face.hpp"
#include "pencil/inversion/raster.hpp"
#include "pencil/inversion/ray_tiles.hpp"

#include <raywise/core/ids.hpp>

#include <hwy/base.h>

#include <atomic>
#include <cstddef>

namespace raywise::detail {

/// Any hits: the ray of this slot hits something and is not asked again.
HWY_INLINE void set_hit(const Raster& raster, Tile& tile, std::size_t slot) {
    RayTiles& tiles = raster.tiles;
    raster.hits[tiles.index[slot]] = true;
    tiles.near[slot] = infinity;
    tiles.far[slot] = -infinity;
    tile.undecided.store(
        tile.undecided.load(std::memory_order_relaxed) - 1, std::memory_order_relaxed
    );
}

/// Closest hits: asks a triangle and the slot's best one so far exactly, and keeps the closer hit.
void resolve(const Raster& raster, const Face& face, std::size_t slot, PrimId id);

/// Asks every ray about a triangle, exactly.
void ask_all(const Raster& raster, PrimId id);

/// Keeps the undecided slots of a tile, in their bins.
void drop_decided(RayTiles& tiles, Tile& tile);

} // namespace raywise::detail
