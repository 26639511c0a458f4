// The edges of a triangle as a cell's list has them.
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
    std::array<std::int16_t, 9> values;
    bool is_missed; ///< whether no ray of the cell meets the triangle: nothing to list
};

/// Edges of the triangles of a face, whole triangles also where the face's bounds cut them.
class EdgeLines {
public:
    EdgeLines(const FaceMap& map, bool is_radial, const Records& records, Vec3d apex);

    /// Of the triangle whose piece has these bounds in the cell `window`.
    [[nodiscard]] EdgeRows
    rows(const Piece& piece, const Footprint& bounds, const Window& window) const;

private:
    const FaceMap& map_;
    bool is_radial_;
    const float* records_;
    Vec3d apex_;
    double off_ = 0; ///< parallel: how far computed places of vertices may be off, in units
};

} // namespace raywise::pencil_detail
