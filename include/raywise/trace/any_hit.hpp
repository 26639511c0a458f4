// Whether anything stands in the way of a ray: occlusion, shadow rays.
#pragma once

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/trace/observer.hpp>
#include <raywise/trace/traverse.hpp>
#include <raywise/trace/triangles.hpp>

#include <cstddef>
#include <span>

namespace raywise {

/// Whether some triangle is hit at t in [t_min, t_max]: true iff closest_hit finds one. Stops at
/// the first found. Contract as closest_hit.
template <TriangleKernel Kernel = ExactKernel, TriangleSource Triangles, class Observer = Silent>
[[nodiscard]] bool any_hit(
    const Bvh& tree,
    const Triangles& triangles,
    const Ray& ray,
    Observer&& seen = {} // NOLINT(cppcoreguidelines-missing-std-forward): watched, not passed on
) {
    const Kernel kernel(ray);
    bool found = false;
    traverse(tree, ray, seen, [&](const Node& leaf, float& limit) {
        const std::size_t end = leaf.first() + leaf.count();
        for (std::size_t slot = leaf.first(); slot < end && !found; ++slot) {
            const PrimId id = tree.prims[slot];
            seen.prim(id);
            found = kernel(triangles.triangle(tree, slot), id, limit).has_value();
        }
        return !found;
    });
    return found;
}

/// any_hit of every ray, in parallel. Throws Error when the sizes differ.
template <TriangleKernel Kernel = ExactKernel, TriangleSource Triangles>
void any_hits(
    const Bvh& tree,
    const Triangles& triangles,
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor = serial_executor()
) {
    if (rays.size() != occluded.size()) throw Error("as many answers as rays are needed");
    constexpr std::size_t chunk = 1024;
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            occluded[i] = any_hit<Kernel>(tree, triangles, rays[i]);
    });
}

} // namespace raywise
