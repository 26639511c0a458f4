#include "pencil/inversion/answers.hpp"
#include "pencil/inversion/extremes.hpp"
#include "pencil/inversion/face.hpp"
#include "pencil/inversion/raster.hpp"
#include "pencil/inversion/ray_tiles.hpp"
#include "pencil/inversion/tile_lock.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/pencil/pencil.hpp>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace raywise::detail {

void resolve(const Raster& raster, const Face& face, std::size_t slot, PrimId id) {
    RayTiles& tiles = raster.tiles;
    const Ray& ray = raster.rays[tiles.index[slot]];
    const auto ask = [&](PrimId prim, float t_max) {
        return ExactKernel::decide(ray, raster.triangles[prim], prim, t_max);
    };
    const PrimId old{tiles.best[slot]};
    std::optional<Hit> best;
    if (old != no_prim) best = ask(old, ray.t_max);
    const std::optional<Hit> other = ask(id, best ? best->t : ray.t_max);
    if (other && (!best || is_closer(*other, *best))) best = other;
    if (!best) return;
    tiles.best[slot] = static_cast<std::uint32_t>(best->prim);
    const bool is_radial = raster.pencil.kind() == Pencil::Kind::radial;
    const FaceRay seen = is_radial ? face.ray<true>(ray, ray.origin == raster.pencil.apex())
                                   : face.ray<false>(ray, true);
    const double depth = face.depth_at(ray, best->t);
    const double margin = 16 * 0x1p-24 * (std::abs(depth) + std::abs(seen.start) + seen.tiny);
    tiles.far[slot] = lesser(tiles.far[slot], static_cast<float>(depth + margin));
    tiles.least[slot] = static_cast<float>(depth - margin);
}

void ask_all(const Raster& raster, PrimId id) {
    RayTiles& tiles = raster.tiles;
    const Triangle triangle = raster.triangles[id];
    for (std::size_t f = 0; f < tiles.faces.size(); ++f) {
        const Window& window = tiles.windows[f];
        const std::size_t end = window.first_tile + window.columns * window.rows;
        for (std::size_t at = window.first_tile; at < end; ++at) {
            Tile& tile = tiles.tiles[at];
            if (tile.undecided.load(std::memory_order_relaxed) == 0) continue;
            const TileLock lock(tile, raster.is_shared);
            for (std::size_t slot = tile.first; slot < tile.first + tile.count; ++slot) {
                if (!(tiles.near[slot] <= tiles.far[slot])) continue;
                const Ray& ray = raster.rays[tiles.index[slot]];
                if (!ExactKernel(ray)(triangle, id, ray.t_max)) continue;
                if (raster.hits == nullptr)
                    resolve(raster, tiles.faces[f], slot, id);
                else
                    set_hit(raster, tile, slot);
            }
        }
    }
}

void drop_decided(RayTiles& tiles, Tile& tile) {
    std::uint32_t* const starts = &tiles.bin_starts[tile.bins];
    const std::uint32_t bins = tile.columns * tile.rows;
    std::uint32_t to = 0;
    std::uint32_t from = 0;
    float near = infinity;
    float far = -infinity;
    for (std::uint32_t bin = 0; bin < bins; ++bin) {
        const std::uint32_t end = starts[bin + 1];
        starts[bin] = to;
        for (; from < end; ++from) {
            const std::size_t a = tile.first + from;
            if (!(tiles.near[a] <= tiles.far[a])) continue;
            const std::size_t b = tile.first + to++;
            tiles.u[b] = tiles.u[a];
            tiles.v[b] = tiles.v[a];
            tiles.near[b] = tiles.near[a];
            tiles.far[b] = tiles.far[a];
            near = lesser(near, tiles.near[b]);
            far = greater(far, tiles.far[b]);
            tiles.excluded[b] = tiles.excluded[a];
            tiles.index[b] = tiles.index[a];
        }
    }
    starts[bins] = to;
    // Vectors read on: what is left behind must not be asked again.
    for (std::uint32_t slot = to; slot < tile.count; ++slot) {
        tiles.near[tile.first + slot] = infinity;
        tiles.far[tile.first + slot] = -infinity;
    }
    tile.count = to;
    tile.near.store(near, std::memory_order_relaxed);
    tile.far.store(far, std::memory_order_relaxed);
}

} // namespace raywise::detail
