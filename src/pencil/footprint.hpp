// The part of a piece inside a window: its bounds and depths, and whether it fills the window.
#pragma once

#include "pencil/piece.hpp"

#include <cstdint>

namespace raywise::pencil_detail {

/// A square of the face: the places u with first_u <= u < first_u + side, and so for v, in units.
struct Window {
    std::int32_t first_u;
    std::int32_t first_v;
    std::int32_t side;
};

/// Bounds of where queries of the window can meet the piece, margin included, limited to the
/// window; empty when least_u > greatest_u. Keys are bounds of those of the piece within the window
/// and its margin.
struct Footprint {
    std::int32_t least_u, greatest_u;
    std::int32_t least_v, greatest_v;
    double least_key, greatest_key;
};

/// Those of the piece's bounds, where they are in the window: wider than need be where its edges
/// cut the window's corners.
[[nodiscard]] Footprint footprint(const Piece& piece, const Window& window);

/// Whether every ray of the window meets the inside of the piece.
[[nodiscard]] bool fills(const Piece& piece, const Window& window);

} // namespace raywise::pencil_detail
