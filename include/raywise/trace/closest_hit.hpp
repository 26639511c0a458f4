// The nearest triangle along a ray.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/trace/observer.hpp>
#include <raywise/trace/triangles.hpp>

#include <optional>
#include <span>

namespace raywise {

/// The hit with the smallest (t, triangle id) among those with t in [t_min, t_max], as the kernel
/// defines a hit; with ExactKernel the answer is the same for every tree over the same triangles.
/// `triangles` belong to `tree`. Nothing for an empty tree or an invalid ray. No allocation; safe
/// from any number of threads.
template <TriangleKernel Kernel = ExactKernel, TriangleSource Triangles, class Observer = Silent>
[[nodiscard]] std::optional<Hit>
closest_hit(const Bvh& tree, const Triangles& triangles, const Ray& ray, Observer&& seen = {});

/// closest_hit of every ray, in parallel; a miss is `Hit{}` (t = +inf, prim = no_prim). Throws
/// Error when `hits` and `rays` differ in size.
template <TriangleKernel Kernel = ExactKernel, TriangleSource Triangles>
void closest_hits(
    const Bvh& tree,
    const Triangles& triangles,
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor = serial_executor()
);

} // namespace raywise

#include <raywise/trace/closest_hit.inl.hpp> // IWYU pragma: export
