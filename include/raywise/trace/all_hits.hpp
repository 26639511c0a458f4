// Every triangle along a ray.
#pragma once

#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/trace/observer.hpp>
#include <raywise/trace/traverse.hpp>
#include <raywise/trace/triangles.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace raywise {

/// Calls `visit(const Hit&)` for every hit with t in [t_min, t_max], in no particular order. A
/// triangle that stands in several slots may be visited once for each. Contract as closest_hit.
template <
    TriangleKernel Kernel = ExactKernel,
    TriangleSource Triangles,
    class Visitor,
    class Observer = Silent>
void all_hits(
    const Bvh& tree,
    const Triangles& triangles,
    const Ray& ray,
    Visitor&& visit,
    Observer&& seen = {} // NOLINT(cppcoreguidelines-missing-std-forward): watched, not passed on
) {
    const Kernel kernel(ray);
    traverse(tree, ray, seen, [&](const Node& leaf, float& limit) {
        const std::size_t end = leaf.first() + leaf.count();
        for (std::size_t slot = leaf.first(); slot < end; ++slot) {
            const PrimId id = tree.prims[slot];
            seen.prim(id);
            if (const auto hit = kernel(triangles.triangle(tree, slot), id, limit)) visit(*hit);
        }
        return true;
    });
}

/// Sorts by (t, id) and drops what was visited twice.
inline void sort_hits(std::vector<Hit>& hits) {
    std::sort(hits.begin(), hits.end(), is_closer);
    const auto is_same = [](const Hit& a, const Hit& b) { return a.prim == b.prim; };
    hits.erase(std::unique(hits.begin(), hits.end(), is_same), hits.end());
}

/// All hits by (t, id), each triangle once. Allocates the answer.
template <TriangleKernel Kernel = ExactKernel, TriangleSource Triangles>
[[nodiscard]] std::vector<Hit>
sorted_hits(const Bvh& tree, const Triangles& triangles, const Ray& ray) {
    std::vector<Hit> hits;
    all_hits<Kernel>(tree, triangles, ray, [&](const Hit& hit) { hits.push_back(hit); });
    sort_hits(hits);
    return hits;
}

} // namespace raywise
