// The part of a piece inside a window: its bounds and depths, and whether it fills the window.
#pragma once

#include "pencil/piece.hpp"

#include <cstdint>
#include <optional>

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

/// The plane of a piece: key = key_at + slope_u * (u - at_u) + slope_v * (v - at_v), in units.
struct KeyPlane {
    double at_u, at_v;
    double key_at;
    double slope_u, slope_v;

    [[nodiscard]] double at(double u, double v) const {
        return key_at + slope_u * (u - at_u) + slope_v * (v - at_v);
    }
};

/// Slopes are right to 2^-30, relatively to the steepest; nothing for pieces seen too much from
/// their edge.
[[nodiscard]] std::optional<KeyPlane> key_plane(const Piece& piece);

} // namespace raywise::pencil_detail
