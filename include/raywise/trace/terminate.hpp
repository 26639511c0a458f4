// Rays cut where they are stopped: what a tree for these rays has to be good at.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace raywise {

/// The rays, each ending at its closest hit if it has one: an ordered traversal visits the boxes
/// that these meet, and few others. Contract as closest_hit; the same for any executor.
template <TriangleSource Triangles>
[[nodiscard]] std::vector<Ray> terminated(
    const Bvh& tree,
    const Triangles& triangles,
    std::span<const Ray> rays,
    const Executor& executor = serial_executor()
) {
    std::vector<Ray> segments(rays.begin(), rays.end());
    constexpr std::size_t chunk = 256;
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (const auto hit = closest_hit(tree, triangles, rays[i])) segments[i].t_max = hit->t;
    });
    return segments;
}

} // namespace raywise
