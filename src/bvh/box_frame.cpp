#include <raywise/bvh/box_frame.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <cstdint>

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

FramedMesh
to_frame(const TriangleView& triangles, const BoxFrame& frame, const Executor& executor) {
    if (triangles.size() > 0xFFFFFFFFU / 3) throw Error("frame: too many triangles");
    FramedMesh mesh;
    mesh.vertices.resize(3 * triangles.size());
    mesh.corners.resize(triangles.size());
    constexpr std::size_t chunk = 8192;
    executor.for_each_chunk(triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Triangle triangle = triangles[to_prim(i)];
            mesh.vertices[3 * i] = frame.to_frame(triangle.v0);
            mesh.vertices[3 * i + 1] = frame.to_frame(triangle.v1);
            mesh.vertices[3 * i + 2] = frame.to_frame(triangle.v2);
            const auto first = static_cast<std::uint32_t>(3 * i);
            mesh.corners[i] = {first, first + 1, first + 2};
        }
    });
    return mesh;
}

} // namespace raywise
