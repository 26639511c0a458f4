// Rays that an area's user may ask for, to judge structures by.
#pragma once

#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise::detail {

/// `count` rays of the area's distribution that start somewhere along their way through the region;
/// rays as sampled start on the window, which may lie on the region's border or outside.
[[nodiscard]] std::vector<Ray>
sampled_rays(const InfluenceArea& area, std::size_t count, std::uint64_t seed);

/// `count` shadow rays from random points of random triangles to the emitter of a parallel or
/// radial area; sampled_rays for other areas. At least one triangle.
[[nodiscard]] std::vector<Ray> sampled_shadow_rays(
    const InfluenceArea& area,
    const TriangleView& triangles,
    std::size_t count,
    std::uint64_t seed
);

} // namespace raywise::detail
