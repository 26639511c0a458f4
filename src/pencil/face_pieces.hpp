// What a face sees: its map and its pieces.
#pragma once

#include "pencil/grid_data.hpp"
#include "pencil/piece.hpp"
#include "pencil/records.hpp"

#include <raywise/core/executor.hpp>
#include <raywise/pencil/pencil.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise::pencil_detail {

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

/// What a radial pencil has around its apex.
struct Surroundings {
    static constexpr std::uint8_t several = 6;

    Vec3d apex;
    double reach = 0;           ///< rays come from at most so far away
    double nearest = 0;         ///< where pieces begin
    std::vector<PrimId> near{}; ///< triangles that rays may meet before, ascending
    std::vector<std::uint8_t> faces{
    }; ///< that alone see the triangles of Records::ids, or `several`
};

[[nodiscard]] Surroundings
look_around(const Records& records, const Vec3d& apex, const Executor& executor);

/// The pieces of one of the six cube faces: 2 * axis, and one more for its negative side. In order
/// of ids.
[[nodiscard]] std::vector<RawPiece> radial_pieces(
    const Records& records,
    const Surroundings& around,
    std::size_t face,
    const Executor& executor
);

/// The pieces of a parallel pencil's only face.
[[nodiscard]] std::vector<RawPiece>
parallel_pieces(const Records& records, Vec3 direction, const Executor& executor);

} // namespace raywise::pencil_detail
