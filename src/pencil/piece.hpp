// A triangle as a face sees it, snapped to units.
#pragma once

#include "pencil/grid_data.hpp"

#include <raywise/core/ids.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

namespace raywise::pencil_detail {

/// Radial keys are right to this share of themselves, as floats; parallel ones exactly.
inline constexpr double key_rounding = 0x1p-22;

/// How far a shadow ray toward an apex strays at most, as a slope, where the apex is nearer than
/// the ray's origin by a factor of (1 - t) after the share t of its way: times t / (1 - t).
inline constexpr double stray_share = 0x1p-22;

/// The least and the greatest of three numbers. Called for every reference, where the loop of
/// std::minmax is felt.
template <class T>
struct Extremes {
    explicit Extremes(const std::array<T, 3>& x)
        : least(std::min(std::min(x[0], x[1]), x[2]))
        , greatest(std::max(std::max(x[0], x[1]), x[2])) {}

    T least, greatest;
};

/// A triangle, or a part of one that was cut by the bounds of a cube face. A ray of the pencil that
/// meets the part passes, in units, within `margin - 1` of the place where a query says it is; each
/// corner is within 1 of its place along u and v.
struct Piece {
    std::array<std::int32_t, 3> u;
    std::array<std::int32_t, 3> v;
    std::array<float, 3> key; ///< linear across the face, ascending with depth: z, or -1 / z
    std::int32_t margin;
    PrimId prim;
    bool is_part; ///< whether other pieces have the same triangle
    bool is_near; ///< whether a ray that meets the triangle near the apex may miss all its pieces

    [[nodiscard]] std::int32_t least_u() const { return Extremes(u).least - margin; }

    [[nodiscard]] std::int32_t greatest_u() const { return Extremes(u).greatest + margin; }

    [[nodiscard]] std::int32_t least_v() const { return Extremes(v).least - margin; }

    [[nodiscard]] std::int32_t greatest_v() const { return Extremes(v).greatest + margin; }
};

} // namespace raywise::pencil_detail
