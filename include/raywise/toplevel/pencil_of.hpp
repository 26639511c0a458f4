// From an influence area to the pencil of its exact rays.
#pragma once

#include <raywise/distribution/influence_area.hpp>
#include <raywise/pencil/pencil.hpp>

#include <optional>

namespace raywise {

/// The pencil that all rays of the area share: the direction of a parallel area without a cone or
/// the eye of a radial one without a radius, rounded to float. Nothing for other areas: their rays
/// are near-affine at best. Where the rounding leaves nothing finite, nothing either.
[[nodiscard]] std::optional<Pencil> pencil_of(const InfluenceArea& area);

/// The same for the middle of a cone or a ball: where the rays of a blurred emitter run on average.
/// Nothing for uniform and measured areas.
[[nodiscard]] std::optional<Pencil> central_pencil_of(const InfluenceArea& area);

} // namespace raywise
