// Triangles drawn over rays, picture by picture, tile by tile, run by run. Included once for every
// instruction set.
#if defined(RAYWISE_PENCIL_INVERSION_DRAWING) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_INVERSION_DRAWING
#undef RAYWISE_PENCIL_INVERSION_DRAWING
#else
#define RAYWISE_PENCIL_INVERSION_DRAWING
#endif

#include "pencil/inversion/aim.inl.hpp"
#include "pencil/inversion/answers.hpp"
#include "pencil/inversion/draw_run.inl.hpp"
#include "pencil/inversion/drawn.hpp"
#include "pencil/inversion/raster.hpp"
#include "pencil/inversion/ray_tiles.hpp"
#include "pencil/inversion/tile_lock.hpp"
#include "pencil/inversion/visible.hpp"
#include "pencil/inversion/walk.inl.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();

namespace raywise::detail::HWY_NAMESPACE {

/// Zero times a float is a number only when it is finite.
HWY_INLINE bool is_finite(const Triangle& t) {
    const auto& [a, b, c] = t;
    return 0 * a.x + 0 * a.y + 0 * a.z + 0 * b.x + 0 * b.y + 0 * b.z + 0 * c.x + 0 * c.y +
               0 * c.z ==
           0;
}

/// Draws triangles a few at a time: shots are gathered, then fired together.
template <bool is_radial, bool is_closest>
class Drawing {
public:
    // NOLINTNEXTLINE(*-member-init): of the arrays, only what is counted is read
    explicit Drawing(const Raster& raster) : raster_(raster), tiles_(raster.tiles) {
        for (const Window& window : tiles_.windows) {
            brink_ = greater(brink_, window.brink);
            reach_ = greater(reach_, window.reach);
        }
    }

    /// Soon, or at the latest by `finish`.
    void draw(PrimId id) {
        const Triangle triangle = raster_.triangles[id];
        if (!is_finite(triangle)) return;
        if constexpr (is_radial)
            draw_around(id, triangle);
        else
            draw_along(id, triangle);
    }

    void finish() {
        shoot_all();
        drawn_count_ = 0;
    }

private:
    HWY_INLINE void draw_around(PrimId id, const Triangle& triangle) {
        const Around around = look_around(apex_, triangle);
        // Rays that end at the apex pass it by a rounding, rays that start there may hit what
        // touches it from any side: no picture shows that.
        if (around.distance <= brink_) {
            ask_all(raster_, id);
            return;
        }
        const double slack = 0x1p-40 + 2.1 * 0x1p-24 * greater(1.0, 2 * reach_ / around.distance);
        for (std::size_t f = 0; f < tiles_.faces.size(); ++f) {
            const Window& window = tiles_.windows[f];
            if (window.is_empty() || !may_face(around, f, slack)) continue;
            Drawn& drawn = next_drawn(id, f, triangle);
            measure_depth(drawn);
            drawn.size = around.size;
            drawn.distance = around.distance;
            if (show_radial(drawn, window)) add_shots(drawn, f);
        }
    }

    HWY_INLINE void draw_along(PrimId id, const Triangle& triangle) {
        const Window& window = tiles_.windows[0];
        if (window.is_empty()) return;
        Drawn& drawn = next_drawn(id, 0, triangle);
        measure_parallel(drawn);
        if (show_parallel(drawn, window, raster_.pencil.direction(), triangle)) add_shots(drawn, 0);
    }

    Drawn& next_drawn(PrimId id, std::size_t face, const Triangle& triangle) {
        if (drawn_count_ == drawn_.size()) finish();
        Drawn& drawn = drawn_[drawn_count_];
        drawn.id = id;
        drawn.p[0] = tiles_.faces[face].point<is_radial>(triangle.v0);
        drawn.p[1] = tiles_.faces[face].point<is_radial>(triangle.v1);
        drawn.p[2] = tiles_.faces[face].point<is_radial>(triangle.v2);
        return drawn;
    }

    /// Shots on all tiles that the last triangle drawn may meet.
    void add_shots(const Drawn& t, std::size_t face) {
        ++drawn_count_;
        const Window& window = tiles_.windows[face];
        Tile* const tiles = tiles_.tiles.data() + window.first_tile;
        for_each_tile<is_radial>(t, window, [&](std::uint32_t tile) HWY_ATTR {
            add_shot(t, face, tiles[tile]);
        });
    }

    void add_shot(const Drawn& t, std::size_t face, Tile& tile) {
        if (shot_count_ == shots_.size()) shoot_all();
        hwy::Prefetch(&tile);
        hwy::Prefetch(reinterpret_cast<const std::byte*>(&tile) + 64);
        Shot& shot = shots_[shot_count_++];
        shot.drawn = &t;
        shot.tile = &tile;
        shot.face = static_cast<std::uint32_t>(face);
    }

    /// In three passes, so that the memory of each step is on its way while others are worked on.
    void shoot_all() {
        std::size_t count = 0;
        for (std::size_t i = 0; i < shot_count_; ++i) {
            Shot& shot = shots_[count];
            shot.drawn = shots_[i].drawn;
            shot.tile = shots_[i].tile;
            shot.face = shots_[i].face;
            if (!aim<is_radial>(shot)) continue;
            hwy::Prefetch(first_start(shot));
            ++count;
        }
        for (std::size_t i = 0; i < count; ++i)
            prefetch_slots(shots_[i]);
        for (std::size_t i = 0; i < count; ++i)
            shoot(shots_[i]);
        shot_count_ = 0;
    }

    [[nodiscard]] const std::uint32_t* first_start(const Shot& shot) const {
        const Tile& tile = *shot.tile;
        return &tiles_.bin_starts[tile.bins + shot.row_lo * tile.columns + shot.column_lo];
    }

    void prefetch_slots(const Shot& shot) const {
        std::size_t slot = shot.tile->first;
        {
            const TileLock lock(*shot.tile, raster_.is_shared);
            slot += *first_start(shot);
        }
        hwy::Prefetch(&tiles_.near[slot]);
        hwy::Prefetch(&tiles_.far[slot]);
        hwy::Prefetch(&tiles_.u[slot]);
        hwy::Prefetch(&tiles_.v[slot]);
    }

    void shoot(const Shot& shot) {
        Tile& tile = *shot.tile;
        const TileLock lock(tile, raster_.is_shared);
        const RunDrawing<is_radial, is_closest> draw_run(raster_, shot, is_reversed_);
        const std::uint32_t* const starts = &tiles_.bin_starts[tile.bins];
        for_each_run(
            shot,
            [&](std::uint32_t row, std::uint32_t first, std::uint32_t last) HWY_ATTR {
                const std::uint32_t* const row_starts = starts + std::size_t{row} * tile.columns;
                draw_run(tile.first + row_starts[first], tile.first + row_starts[last + 1]);
            }
        );
        const std::uint32_t undecided = tile.undecided.load(std::memory_order_relaxed);
        if (undecided * 2 < tile.count && tile.count > 32) drop_decided(tiles_, tile);
    }

    const Raster& raster_;
    RayTiles& tiles_;
    std::array<Drawn, 32> drawn_;
    std::array<Shot, 64> shots_;
    std::size_t drawn_count_ = 0;
    std::size_t shot_count_ = 0;
    Vec3d apex_ = is_radial ? to_double(raster_.pencil.apex()) : Vec3d{};
    double brink_ = 0;
    double reach_ = 0;
    bool is_reversed_ = tiles_.faces[0].is_reversed();
};

} // namespace raywise::detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
