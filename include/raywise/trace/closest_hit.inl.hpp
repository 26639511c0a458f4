// Bodies of closest_hit.hpp.
#pragma once

#include <raywise/core/error.hpp>
#include <raywise/trace/closest_hit.hpp>
#include <raywise/trace/traverse.hpp>

#include <cstddef>

namespace raywise {

template <TriangleKernel Kernel, TriangleSource Triangles, class Observer>
std::optional<Hit> closest_hit(
    const Bvh& tree,
    const Triangles& triangles,
    const Ray& ray,
    Observer&& seen // NOLINT(cppcoreguidelines-missing-std-forward): watched, not passed on
) {
    const Kernel kernel(ray);
    Hit best;
    traverse(tree, ray, seen, [&](const Node& leaf, float& limit) {
        const std::size_t end = leaf.first() + leaf.count();
        for (std::size_t slot = leaf.first(); slot < end; ++slot) {
            const PrimId id = tree.prims[slot];
            seen.prim(id);
            const auto hit = kernel(triangles.triangle(tree, slot), id, limit);
            if (hit && is_closer(*hit, best)) {
                best = *hit;
                limit = hit->t;
            }
        }
        return true;
    });
    if (best.prim == no_prim) return std::nullopt;
    return best;
}

template <TriangleKernel Kernel, TriangleSource Triangles>
void closest_hits(
    const Bvh& tree,
    const Triangles& triangles,
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor
) {
    if (rays.size() != hits.size()) throw Error("as many hits as rays are needed");
    constexpr std::size_t chunk = 1024;
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            hits[i] = closest_hit<Kernel>(tree, triangles, rays[i]).value_or(Hit{});
    });
}

} // namespace raywise
