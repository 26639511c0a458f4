// Which side of a triangle parallel rays see, exactly.
#pragma once

#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise::detail {

/// The sign of direction . ((v1 - v0) x (v2 - v0)), exact for all finite floats.
[[nodiscard]] int exact_facing(Vec3 direction, const Triangle& triangle);

} // namespace raywise::detail
