// A triangle aimed at one tile: its edges there, and the bins that it may meet. Included once for
// every instruction set.
#if defined(RAYWISE_PENCIL_INVERSION_AIM) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_INVERSION_AIM
#undef RAYWISE_PENCIL_INVERSION_AIM
#else
#define RAYWISE_PENCIL_INVERSION_AIM
#endif

#include "pencil/inversion/drawn.hpp"
#include "pencil/inversion/edges.hpp"
#include "pencil/inversion/ray_tiles.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>

HWY_BEFORE_NAMESPACE();

namespace raywise::detail::HWY_NAMESPACE {

/// One tile that a triangle may be drawn on.
struct Shot {
    const Drawn* drawn;
    Tile* tile;
    std::uint32_t face;
    std::uint32_t column_lo, column_hi, row_lo, row_hi; ///< bins
    Edges edges;
};

/// By how much a ray of this reach may be off in the picture where it meets the triangle.
template <bool is_radial>
HWY_INLINE double aside_of(const Drawn& t, double reach) {
    if constexpr (is_radial) {
        if (reach > 0) return deviation(t, reach);
    }
    return 0;
}

/// What doubles are off on a tile, generously.
template <bool is_radial>
HWY_INLINE double noise_of(const Drawn& t, const Tile& tile) {
    if constexpr (is_radial) return 0x1p-42;
    return 0x1p-48 * (t.size + std::abs(tile.u) + std::abs(tile.v));
}

HWY_INLINE void set_bins(Shot& shot, float u_lo, float u_hi, float v_lo, float v_hi) {
    shot.column_lo = shot.tile->column(u_lo);
    shot.column_hi = shot.tile->column(u_hi);
    shot.row_lo = shot.tile->row(v_lo);
    shot.row_hi = shot.tile->row(v_hi);
}

/// Whether the triangle is nowhere at a depth where a ray of the tile is undecided.
HWY_INLINE bool is_out_of_depth(const Drawn& t, const Tile& tile) {
    // Outward, so that rounding never skips a tile.
    return t.depth_lo * (1 + std::copysign(0x1p-22, -t.depth_lo)) >
               static_cast<double>(tile.far.load(std::memory_order_relaxed)) ||
           t.depth_hi * (1 + std::copysign(0x1p-22, t.depth_hi)) <
               static_cast<double>(tile.near.load(std::memory_order_relaxed));
}

enum class Aim : std::uint8_t { beside, met, not_in_floats };

/// For a flat triangle.
template <bool is_radial>
HWY_INLINE Aim aim_flat(Shot& shot, double aside) {
    const Drawn& t = *shot.drawn;
    const Tile& tile = *shot.tile;
    const FlatCorners corners = flat_corners(t, tile);
    const auto noise = static_cast<float>(noise_of<is_radial>(t, tile)) * 1.0001F;
    const auto off = static_cast<float>(aside) * 1.0001F;
    const float room =
        4 * 0x1p-24F * (corners.greatest + tile.half_u + tile.half_v) + noise + off + 0x1p-140F;
    const float x_lo = corners.x_lo - room;
    const float x_hi = corners.x_hi + room;
    const float y_lo = corners.y_lo - room;
    const float y_hi = corners.y_hi + room;
    if (x_lo > tile.half_u || x_hi < -tile.half_u || y_lo > tile.half_v || y_hi < -tile.half_v)
        return Aim::beside;
    if (!make_flat_edges(shot.edges, t, tile, corners, noise, off)) return Aim::not_in_floats;
    set_bins(shot, x_lo, x_hi, y_lo, y_hi);
    return Aim::met;
}

/// Sets the edges and bins of a shot; false: it meets no ray.
template <bool is_radial>
bool aim(Shot& shot) {
    const Drawn& t = *shot.drawn;
    const Tile& tile = *shot.tile;
    if (tile.undecided.load(std::memory_order_relaxed) == 0 || is_out_of_depth(t, tile))
        return false;
    const double aside = aside_of<is_radial>(t, static_cast<double>(tile.start));
    if (t.is_flat) {
        const Aim aimed = aim_flat<is_radial>(shot, aside);
        if (aimed != Aim::not_in_floats) return aimed == Aim::met;
    }
    const auto half_u = static_cast<double>(tile.half_u);
    const auto half_v = static_cast<double>(tile.half_v);
    const double u_lo = t.u_lo - tile.u - 8 * 0x1p-24 * half_u - 0x1p-148;
    const double u_hi = t.u_hi - tile.u + 8 * 0x1p-24 * half_u + 0x1p-148;
    const double v_lo = t.v_lo - tile.v - 8 * 0x1p-24 * half_v - 0x1p-148;
    const double v_hi = t.v_hi - tile.v + 8 * 0x1p-24 * half_v + 0x1p-148;
    if (u_lo > half_u || u_hi < -half_u || v_lo > half_v || v_hi < -half_v) return false;
    const auto clamped = [](double at, double half) {
        return static_cast<float>(std::clamp(at, -half, half));
    };
    set_bins(
        shot,
        clamped(u_lo, half_u),
        clamped(u_hi, half_u),
        clamped(v_lo, half_v),
        clamped(v_hi, half_v)
    );
    make_edges<is_radial>(shot.edges, t, tile, aside);
    return true;
}

} // namespace raywise::detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
