// A place in a scene with room around it, such as one would hang a lamp in.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstdint>

namespace raywise {

/// Of 64 points uniform in the middle half of `box`, the one farthest from the triangles; of a
/// large scene every n-th of about 2^16 triangles counts. The first of equals.
[[nodiscard]] Vec3d
find_open_place(const TriangleView& triangles, const Aabb& box, std::uint64_t seed);

} // namespace raywise
