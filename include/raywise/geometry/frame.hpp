// The orthonormal frame of a direction: right, up, forward.
#pragma once

#include <raywise/geometry/vec.hpp>

namespace raywise {

/// A right-handed orthonormal basis. `forward` points along the rays.
struct Frame {
    Vec3d right{1, 0, 0};
    Vec3d up{0, 1, 0};
    Vec3d forward{0, 0, 1};
};

/// The frame of `direction` (finite, any nonzero length; throws Error otherwise). World up is +Y;
/// within 1e-4 rad of it, right is the part of +X across the direction, so ceiling lights and noon
/// suns have a frame. `roll_rad` turns right and up about forward, right toward up.
[[nodiscard]] Frame frame_along(Vec3d direction, double roll_rad = 0);

/// Coordinates of a vector in the frame: (along right, along up, along forward).
[[nodiscard]] constexpr Vec3d to_frame(const Frame& frame, Vec3d vector) {
    return {dot(frame.right, vector), dot(frame.up, vector), dot(frame.forward, vector)};
}

/// The inverse of `to_frame`.
[[nodiscard]] constexpr Vec3d from_frame(const Frame& frame, Vec3d coordinates) {
    return frame.right * coordinates.x + frame.up * coordinates.y + frame.forward * coordinates.z;
}

} // namespace raywise
