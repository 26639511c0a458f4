// Queries one box and one triangle at a time, in double: for the rays that the vector kernels
// refuse, and for machines without vectors of four floats.
#pragma once

#include "trace/simd/wide_kernels.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/observer.hpp>

#include <optional>

namespace raywise::simd {

/// Exact in both modes, for any ray: those that are not valid visit nothing. The trees are not
/// empty.
[[nodiscard]] std::optional<Hit>
closest_scalar(const WideBvh& tree, const Ray& ray, Counts& counts);
[[nodiscard]] bool any_scalar(const WideBvh& tree, const Ray& ray, Counts& counts);
void all_scalar(const WideBvh& tree, const Ray& ray, FunctionRef<void(const Hit&)> visit);

/// These, as a table.
[[nodiscard]] const WideKernelTable& scalar_kernels();

} // namespace raywise::simd
