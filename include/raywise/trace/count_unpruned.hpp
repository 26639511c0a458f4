// The thesis's metric: what a traversal without order and pruning would open. [Falcone24]
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/observer.hpp>

namespace raywise {

/// Opens every box that the half-line origin + t direction, t >= 0, meets, whatever t_min, t_max
/// and the triangles are, and counts: `cost_of` the result is the ray's real cost. A ray that
/// misses the root costs nothing; an invalid ray or an empty tree counts nothing. No allocation.
[[nodiscard]] Counts count_unpruned(const Bvh& tree, const Ray& ray);

} // namespace raywise
