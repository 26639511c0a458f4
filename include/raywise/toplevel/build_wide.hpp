// From triangles and a distribution to the wide tree that its rays are traced through.
#pragma once

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstdint>

namespace raywise {

/// How much care a tree is worth.
enum class TreeQuality : std::uint8_t {
    fast, ///< binned: for scenes that change, or few rays
    high, ///< triangles cut where boxes overlap, then subtrees reinserted: several times the work
};

/// A wide tree for uniform lines. Coordinates must be finite and within 2^60; throws Error
/// otherwise. No triangles: an empty tree. The same bytes for any executor.
[[nodiscard]] WideBvh build_wide(
    const TriangleView& triangles,
    TreeQuality quality = TreeQuality::high,
    const Executor& executor = serial_executor()
);

/// A wide tree for the distribution's rays: its measure, with `surface_share` (in [0, 1)) of the
/// surface area so that boxes that it does not see are not free. As above.
[[nodiscard]] WideBvh build_wide(
    const TriangleView& triangles,
    const Distribution& distribution,
    double surface_share = 0.1,
    TreeQuality quality = TreeQuality::high,
    const Executor& executor = serial_executor()
);

/// A wide tree for rays within `cone_half_angle_deg` (in [0, 60]) of `direction`, its boxes in the
/// sheared frame of that direction: for slanted suns over organic scenes; walls that stand along
/// the axes are better off in the world's. As above.
[[nodiscard]] WideBvh build_framed(
    const TriangleView& triangles,
    Vec3 direction,
    double cone_half_angle_deg,
    TreeQuality quality = TreeQuality::high,
    const Executor& executor = serial_executor()
);

} // namespace raywise
