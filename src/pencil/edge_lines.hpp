// The edges and the plane of a triangle as a cell sees them.
#pragma once

#include "pencil/face_pieces.hpp"
#include "pencil/footprint.hpp"
#include "pencil/grid_data.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/geometry/vec.hpp>

#include <array>
#include <cstdint>

namespace raywise::pencil_detail {

/// Rows edge_u, edge_v, edge_at of the three edges, one edge after another.
struct EdgeRows {
    std::array<std::int16_t, 9> values{};
    bool is_missed = false; ///< whether no ray of the cell meets the triangle: nothing to list
};

/// Where that is known: at + u X + v Y, in units, for the place (X, Y) of a query in half cells
/// from the middle. The query ends before the triangle if it ends more than `error` before this
/// depth; if it ends more than `error` behind, and passes through, it meets the triangle.
struct DepthPlane {
    double at = 0, u = 0, v = 0;
    double error = 0;
    bool is_known = false;
};

/// A triangle as a cell sees it.
struct SeenTriangle {
    EdgeRows edges;
    DepthPlane depth;
};

/// Edges of the triangles of a face, whole triangles also where the face's bounds cut them.
class EdgeLines {
public:
    /// `rounding`: how far a place may be off by the roundings of the map, in units.
    EdgeLines(
        const FaceMap& map,
        bool is_radial,
        const Records& records,
        Vec3d apex,
        double rounding
    );

    /// Asks for what `see` reads of the piece's triangle.
    void prefetch(const Piece& piece) const { records_.prefetch(piece.prim); }

    /// Of the triangle whose piece has these bounds in the cell `window`.
    [[nodiscard]] SeenTriangle
    see(const Piece& piece, const Footprint& bounds, const Window& window) const;

private:
    [[nodiscard]] DepthPlane found_by_place(const DepthPlane& plane, const Window& window) const;

    const FaceMap& map_;
    bool is_radial_;
    const Records& records_;
    Vec3d apex_;
    double place_error_; ///< how far, in units, a query is from its place where it begins, at most
    double off_ = 0;     ///< parallel: how far computed places of vertices may be off, in units
};

} // namespace raywise::pencil_detail
