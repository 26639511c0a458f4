// The coordinates of a tree's boxes: the world's, or the world's sheared so that rays of about one
// direction run along an axis, where boxes around slanted gaps are tighter.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/geometry/triangle_copy.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

/// x_k - slopes_k * x_axis for each coordinate k: the dominant axis of the rays stays as it is, and
/// t keeps its meaning. The default is the world.
struct BoxFrame {
    Vec3 slopes; ///< in [-1, 1]; 0 along `axis`
    int axis = 0;

    [[nodiscard]] bool is_world() const { return slopes == Vec3{}; }

    /// Rounded to nearest: within 2^-23 of the largest coordinate of `point`.
    [[nodiscard]] Vec3 to_frame(Vec3 point) const {
        const auto along = static_cast<double>(point[axis]);
        const Vec3d exact = to_double(point) - to_double(slopes) * along;
        return to_float(exact);
    }

    friend bool operator==(const BoxFrame&, const BoxFrame&) = default;
};

/// The frame whose `axis` rays of this direction run along. Throws Error when the direction is zero
/// or not finite.
[[nodiscard]] BoxFrame box_frame_along(Vec3d direction);

/// Triangle i of the result is triangle i of `triangles` in the frame. At most 2^32 / 3 triangles;
/// Error above.
[[nodiscard]] TriangleCopy to_frame(
    const TriangleView& triangles,
    const BoxFrame& frame,
    const Executor& executor = serial_executor()
);

} // namespace raywise
