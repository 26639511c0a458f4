// Orders in which rays that are likely to meet the same triangles stand together. After [Morton66].
#pragma once

#include <raywise/geometry/ray.hpp>

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace raywise {

/// What decides which rays are neighbors, along a Morton curve. [Morton66]
enum class RayOrder : std::uint8_t {
    origin,          ///< where they start
    octant_origin,   ///< the signs of their directions, then where they start
    direction,       ///< where they point to: rays from or to one point
    across_direction ///< where they start, as seen along the first ray: parallel rays
};

/// "origin", "octant_origin", "direction", "across_direction".
[[nodiscard]] std::string_view name_of(RayOrder order);

/// The places of the rays in that order: order[0] is the place of the first. Rays with equal keys
/// keep their order; invalid rays may stand anywhere. A radix sort over 30 bits: O(n); at most 2^32
/// - 1 rays, throws Error beyond.
[[nodiscard]] std::vector<std::uint32_t> sorted_places(std::span<const Ray> rays, RayOrder order);

} // namespace raywise
