// What a face sees: its map and its pieces.
#pragma once

#include "pencil/grid_data.hpp"
#include "pencil/piece.hpp"

#include <raywise/core/executor.hpp>
#include <raywise/pencil/pencil.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raywise::pencil_detail {

/// World vertices of a triangle, coordinate by coordinate: x of v0, v1, v2, then y, then z.
inline constexpr std::size_t record_floats = 9;

/// The triangles as the build reads them, and their range.
struct Records {
    const float* values;         ///< record_floats each
    std::span<const PrimId> ids; ///< of those that are finite
    double greatest;             ///< magnitude of a coordinate
};

/// A face before its units are chosen: corners in scene units across (parallel) or slopes (radial).
struct RawPiece {
    std::array<double, 3> u;
    std::array<double, 3> v;
    std::array<float, 3> key;
    float margin; ///< radial: how far, as a slope, a shadow ray may stray at the least depth
    PrimId prim;
    bool is_part;
    bool is_near; ///< whether the triangle goes on near the apex, where no piece is
};

/// The pieces of the cube face on the side `sign` of `axis`, beyond `nearest` from the apex; rays
/// come from at most `reach` away; `near` are the triangles that may be met before. In order of
/// ids, as `near` is.
[[nodiscard]] std::vector<RawPiece> radial_pieces(
    const Records& records,
    Vec3 apex,
    int axis,
    int sign,
    double nearest,
    double reach,
    std::span<const PrimId> near,
    const Executor& executor
);

/// The pieces of a parallel pencil's only face.
[[nodiscard]] std::vector<RawPiece>
parallel_pieces(const Records& records, Vec3 direction, const Executor& executor);

} // namespace raywise::pencil_detail
