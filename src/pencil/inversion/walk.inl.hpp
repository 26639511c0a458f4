// The tiles of a window, and the bins of a tile, that a triangle may meet: row by row, between its
// edges where it is long in both directions. Included once for every instruction set.
#if defined(RAYWISE_PENCIL_INVERSION_WALK) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_INVERSION_WALK
#undef RAYWISE_PENCIL_INVERSION_WALK
#else
#define RAYWISE_PENCIL_INVERSION_WALK
#endif

#include "pencil/inversion/aim.inl.hpp"
#include "pencil/inversion/drawn.hpp"
#include "pencil/inversion/edges.hpp"
#include "pencil/inversion/extremes.hpp"
#include "pencil/inversion/ray_tiles.hpp"

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();

namespace raywise::detail::HWY_NAMESPACE {

/// A window as one tile, for edges over all of it.
HWY_INLINE void set_whole(Tile& whole, const Window& window) {
    whole.u = (window.u_lo + window.u_hi) / 2;
    whole.v = (window.v_lo + window.v_hi) / 2;
    whole.half_u = static_cast<float>((window.u_hi - window.u_lo) * 0.50001);
    whole.half_v = static_cast<float>((window.v_hi - window.v_lo) * 0.50001);
}

/// Calls visit(tile), by its number in the window, for every tile that the triangle may meet.
template <bool is_radial, class Visit>
HWY_INLINE void for_each_tile(const Drawn& t, const Window& window, const Visit& visit) {
    const std::uint32_t column_lo = window.column(t.u_lo), column_hi = window.column(t.u_hi);
    const std::uint32_t row_lo = window.row(t.v_lo), row_hi = window.row(t.v_hi);
    if (column_hi - column_lo < 2 || row_lo == row_hi) {
        for (std::uint32_t row = row_lo; row <= row_hi; ++row)
            for (std::uint32_t column = column_lo; column <= column_hi; ++column)
                visit(row * window.columns + column);
        return;
    }
    Tile whole;
    set_whole(whole, window);
    Edges edges; // NOLINT(*-member-init)
    make_edges<is_radial>(edges, t, whole, aside_of<is_radial>(t, window.reach));
    const RowClipper clip(edges);
    const double extra = 0x1p-18 * static_cast<double>(whole.half_v);
    const double room = 0x1p-18 * static_cast<double>(whole.half_u);
    for (std::uint32_t row = row_lo; row <= row_hi; ++row) {
        double lo = window.v_lo;
        double hi = window.v_hi;
        if (row > 0) lo = window.v + row / window.per_v - extra;
        if (row + 1 < window.rows) hi = window.v + (row + 1) / window.per_v + extra;
        const auto below = static_cast<float>(lo - whole.v);
        const auto above = static_cast<float>(hi - whole.v);
        float from = -whole.half_u, to = whole.half_u;
        if (!clip(below, above, from, to)) continue;
        const std::uint32_t first =
            greater(column_lo, window.column(whole.u + static_cast<double>(from) - room));
        const std::uint32_t last =
            lesser(column_hi, window.column(whole.u + static_cast<double>(to) + room));
        for (std::uint32_t column = first; column <= last; ++column)
            visit(row * window.columns + column);
    }
}

/// Calls visit(row, first, last) for the columns [first, last] of each row of the tile's bins that
/// the triangle may meet.
template <class Visit>
HWY_INLINE void for_each_run(const Shot& shot, const Visit& visit) {
    const Tile& tile = *shot.tile;
    const std::uint32_t column_lo = shot.column_lo, column_hi = shot.column_hi;
    const std::uint32_t row_lo = shot.row_lo, row_hi = shot.row_hi;
    if (column_hi - column_lo < 2 || row_lo == row_hi) {
        for (std::uint32_t row = row_lo; row <= row_hi; ++row)
            visit(row, column_lo, column_hi);
        return;
    }
    const RowClipper clip(shot.edges);
    const float extra = 0x1p-20F * tile.half_v;
    const float room = 0x1p-18F * tile.half_u;
    const float per_row = tile.per_v > 0 ? 1 / tile.per_v : 0;
    for (std::uint32_t row = row_lo; row <= row_hi; ++row) {
        float lo = -tile.half_v, hi = tile.half_v;
        if (row > 0) lo = tile.v0 + static_cast<float>(row) * per_row - extra;
        if (row + 1 < tile.rows) hi = tile.v0 + static_cast<float>(row + 1) * per_row + extra;
        float from = -tile.half_u, to = tile.half_u;
        if (!clip(lo, hi, from, to)) continue;
        const std::uint32_t first = greater(column_lo, tile.column(from - room));
        const std::uint32_t last = lesser(column_hi, tile.column(to + room));
        if (first <= last) visit(row, first, last);
    }
}

} // namespace raywise::detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
