// The cells of the top grid that a piece may touch.
#pragma once

#include "pencil/piece.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace raywise::pencil_detail {

/// The columns that the snapped piece, enlarged by its margin, touches between two values of v.
struct Columns {
    std::int32_t first;
    std::int32_t last;
};

inline Columns columns_between(const Piece& piece, double low, double high) {
    double least = 0x1p40;
    double greatest = -0x1p40;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = i == 2 ? 0 : i + 1;
        double au = piece.u[i], av = piece.v[i], bu = piece.u[j], bv = piece.v[j];
        if (std::max(av, bv) < low || std::min(av, bv) > high) continue;
        const double du = bu - au;
        const double dv = bv - av;
        const auto at = [&](double v) { return au + du * ((v - av) / dv); };
        const double from = av < low ? at(low) : av > high ? at(high) : au;
        const double to = bv < low ? at(low) : bv > high ? at(high) : bu;
        least = std::min({least, from, to});
        greatest = std::max({greatest, from, to});
    }
    // One unit for the roundings.
    return {
        static_cast<std::int32_t>(std::floor(least)) - piece.margin - 1,
        static_cast<std::int32_t>(std::ceil(greatest)) + piece.margin + 1
    };
}

/// Calls `visit(cell)` for the cells, row by row, of a grid of width x height cells, in which a
/// query may meet the piece. Long triangles are walked between their edges, not over their bounds.
template <class Visit>
void for_each_cell(const Piece& piece, std::int32_t width, std::int32_t height, Visit&& visit) {
    const auto cell = [](std::int32_t units, std::int32_t count) {
        return std::clamp(units >> top_shift, 0, count - 1);
    };
    const std::int32_t first_u = cell(piece.least_u(), width);
    const std::int32_t last_u = cell(piece.greatest_u(), width);
    const std::int32_t first_v = cell(piece.least_v(), height);
    const std::int32_t last_v = cell(piece.greatest_v(), height);
    const auto visit_row = [&](std::int32_t row, std::int32_t first, std::int32_t last) {
        const auto start = static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
        for (std::int32_t column = first; column <= last; ++column)
            visit(start + static_cast<std::size_t>(column));
    };
    if (first_u == last_u || first_v == last_v ||
        (last_u - first_u == 1 && last_v - first_v == 1)) {
        for (std::int32_t row = first_v; row <= last_v; ++row)
            visit_row(row, first_u, last_u);
        return;
    }
    for (std::int32_t row = first_v; row <= last_v; ++row) {
        const double low = static_cast<double>(std::int64_t{row} << top_shift) - piece.margin;
        const double high = low + (1 << top_shift) + 2.0 * piece.margin;
        const Columns columns = columns_between(piece, low, high);
        visit_row(
            row,
            std::max(first_u, cell(columns.first, width)),
            std::min(last_u, cell(columns.last, width))
        );
    }
}

} // namespace raywise::pencil_detail
