#include <raywise/bvh/box_frame.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_copy.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>

namespace raywise {

BoxFrame box_frame_along(Vec3d direction) {
    if (!is_finite(direction) || direction == Vec3d{})
        throw Error("frame: a direction must be finite and not zero");
    BoxFrame frame;
    frame.axis = dominant_axis(direction);
    frame.slopes = to_float(direction / direction[frame.axis]);
    frame.slopes[frame.axis] = 0;
    return frame;
}

TriangleCopy
to_frame(const TriangleView& triangles, const BoxFrame& frame, const Executor& executor) {
    const auto in_frame = [&](std::size_t i) -> Triangle {
        const auto& [v0, v1, v2] = triangles[to_prim(i)];
        return {frame.to_frame(v0), frame.to_frame(v1), frame.to_frame(v2)};
    };
    return copy_triangles(triangles.size(), in_frame, executor);
}

} // namespace raywise
