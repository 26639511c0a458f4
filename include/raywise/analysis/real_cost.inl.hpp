// Bodies of real_cost.hpp.
#pragma once

#include <raywise/analysis/real_cost.hpp>

namespace raywise {

template <TriangleSource Triangles>
std::vector<TracedRay> trace_closest_counted(
    const Bvh& tree,
    const Triangles& triangles,
    std::span<const Ray> rays,
    const Executor& executor
) {
    constexpr std::size_t chunk = 1024;
    std::vector<TracedRay> traced(rays.size());
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            traced[i].hit = closest_hit(tree, triangles, rays[i], traced[i].counts);
        }
    });
    return traced;
}

template <TriangleSource Triangles>
std::vector<TracedRay> trace_any_counted(
    const Bvh& tree,
    const Triangles& triangles,
    std::span<const Ray> rays,
    const Executor& executor
) {
    constexpr std::size_t chunk = 1024;
    std::vector<TracedRay> traced(rays.size());
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (any_hit(tree, triangles, rays[i], traced[i].counts)) traced[i].hit = Hit{};
        }
    });
    return traced;
}

} // namespace raywise
