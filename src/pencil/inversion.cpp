#include <raywise/pencil/inversion.hpp>

#include "pencil/inversion/raster.hpp"
#include "pencil/inversion/ray_tiles.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/pencil/pencil.hpp>

#include <algorithm>
#include <cstddef>
#include <span>

namespace raywise {

namespace {

using detail::Raster;
using detail::RaysAsked;
using detail::RayTiles;
using detail::Tile;

void check_batch(std::size_t rays, std::size_t hits) {
    if (rays != hits) throw Error("inversion: as many answers as rays are needed");
    if (rays > 0x7FFFFFFF) throw Error("inversion: more than 2^31 - 1 rays");
}

void draw_all(const Raster& raster, const Executor& executor) {
    constexpr std::size_t chunk = 4096;
    executor.for_each_chunk(
        raster.triangles.size(),
        chunk,
        [&](std::size_t begin, std::size_t end) { detail::draw(raster, begin, end); }
    );
}

/// What the rays of the tiles hit at last.
void gather(const Raster& raster, std::span<Hit> hits, const Executor& executor) {
    const RayTiles& tiles = raster.tiles;
    executor.for_each_chunk(tiles.tiles.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const Tile& tile = tiles.tiles[t];
            for (std::size_t slot = tile.first; slot < tile.first + tile.count; ++slot) {
                const PrimId id{tiles.best[slot]};
                if (id == no_prim) continue;
                const std::size_t i = tiles.index[slot];
                const Ray& ray = raster.rays[i];
                hits[i] = *ExactKernel::decide(ray, raster.triangles[id], id, ray.t_max);
            }
        }
    });
}

} // namespace

void any_hits_once(
    const TriangleView& triangles,
    const Pencil& pencil,
    std::span<const Ray> rays,
    std::span<bool> hits,
    const Executor& executor
) {
    check_batch(rays.size(), hits.size());
    std::fill(hits.begin(), hits.end(), false);
    if (rays.empty()) return;
    RayTiles tiles(pencil, rays, RaysAsked::all, executor);
    draw_all({triangles, pencil, rays, tiles, hits.data(), executor.threads() > 1}, executor);
}

void closest_hits_once(
    const TriangleView& triangles,
    const Pencil& pencil,
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor
) {
    check_batch(rays.size(), hits.size());
    std::fill(hits.begin(), hits.end(), Hit{});
    if (rays.empty()) return;
    // Rays that run against each other meet triangles in opposite orders.
    for (const RaysAsked asked : {RaysAsked::leaving, RaysAsked::arriving}) {
        RayTiles tiles(pencil, rays, asked, executor);
        if (tiles.seen > 0) {
            const Raster raster{triangles, pencil, rays, tiles, nullptr, executor.threads() > 1};
            draw_all(raster, executor);
            gather(raster, hits, executor);
        }
        if (tiles.skipped == 0) break;
    }
}

double predicted_inversion_ns(Pencil::Kind kind, std::size_t triangles, std::size_t rays) {
    // An apex costs divisions, and the search for the faces of the cube.
    const double per_triangle = kind == Pencil::Kind::parallel ? 100 : 160;
    constexpr double per_ray = 80;
    return per_triangle * static_cast<double>(triangles) + per_ray * static_cast<double>(rays);
}

std::size_t inversion_bytes(std::size_t rays) {
    return RayTiles::most_bytes(rays);
}

} // namespace raywise
