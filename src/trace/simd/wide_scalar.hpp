// Queries for the rays that the kernels refuse: one box and one triangle at a time, in double.
#pragma once

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/ray.hpp>

#include <optional>

namespace raywise::simd {

/// Exact in both modes. The trees are not empty and the rays valid.
[[nodiscard]] std::optional<Hit> closest_scalar(const WideBvh& tree, const Ray& ray);
[[nodiscard]] bool any_scalar(const WideBvh& tree, const Ray& ray);
void all_scalar(const WideBvh& tree, const Ray& ray, FunctionRef<void(const Hit&)> visit);

} // namespace raywise::simd
