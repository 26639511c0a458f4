// Queries without a tree: every triangle is asked. The meaning of all the fast ones.
#pragma once

#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <optional>
#include <vector>

namespace raywise {

/// The hit with the smallest (t, triangle id) in [t_min, t_max], by ExactKernel. Nothing for an
/// invalid ray. O(triangles).
[[nodiscard]] std::optional<Hit>
brute_force_closest_hit(const TriangleView& triangles, const Ray& ray);

/// Whether some triangle is hit in [t_min, t_max].
[[nodiscard]] bool brute_force_any_hit(const TriangleView& triangles, const Ray& ray);

/// All hits in [t_min, t_max] by (t, id).
[[nodiscard]] std::vector<Hit> brute_force_all_hits(const TriangleView& triangles, const Ray& ray);

} // namespace raywise
