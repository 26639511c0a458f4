// A blurred emitter as points: areas of near-affine rays become areas of exact ones.
#pragma once

#include <raywise/distribution/influence_area.hpp>

#include <cstddef>
#include <vector>

namespace raywise {

/// `count` exact areas that stand for one with a cone or a radius: directions spread evenly over
/// the cone by solid angle, or positions of the eye spread evenly over the ball. Named "sun/0",
/// "sun/1", ...; the region and the affinity are the area's, the density is shared equally. Rays of
/// a caller who samples an emitter at fixed points are exact for them, so that pencil grids apply:
/// worth it when each point serves more than a few rays per triangle of the scene. An exact area
/// comes back as `count` equal ones. Uniform and measured areas have no emitter: throws Error; so
/// does count < 1. The same points for the same count, on every platform up to rounding.
[[nodiscard]] std::vector<InfluenceArea> discretized(const InfluenceArea& area, std::size_t count);

} // namespace raywise
