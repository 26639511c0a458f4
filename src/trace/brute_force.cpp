#include <raywise/trace/brute_force.hpp>

#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace raywise {

std::vector<Hit> brute_force_all_hits(const TriangleView& triangles, const Ray& ray) {
    std::vector<Hit> hits;
    if (!is_valid(ray)) return hits;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const PrimId id = to_prim(i);
        if (id == ray.excluded) continue;
        if (const auto hit = ExactKernel::decide(ray, triangles[id], id, ray.t_max))
            hits.push_back(*hit);
    }
    std::ranges::sort(hits, is_closer);
    return hits;
}

std::optional<Hit> brute_force_closest_hit(const TriangleView& triangles, const Ray& ray) {
    const std::vector<Hit> hits = brute_force_all_hits(triangles, ray);
    if (hits.empty()) return std::nullopt;
    return hits.front();
}

bool brute_force_any_hit(const TriangleView& triangles, const Ray& ray) {
    return !brute_force_all_hits(triangles, ray).empty();
}

} // namespace raywise
