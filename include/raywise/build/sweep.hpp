// Top-down build that tries every plane between two neighboring centroids on all three axes: the
// measure of quality for the binned build. After [MacDonald90].
#pragma once

#include <raywise/build/axis_policy.hpp>
#include <raywise/build/binned.hpp>

#include <span>

namespace raywise {

/// As build_binned, with all n - 1 planes of each axis; bin_count is not used. Centroids that
/// coincide on an axis are not separated on it. O(n log^2 n) for splits that share evenly.
template <HitMeasure M, AxisPolicy P = AllAxes>
[[nodiscard]] Bvh build_sweep(
    std::span<const Aabb> boxes,
    const M& measure,
    const BinnedParams& params = {},
    const Executor& executor = serial_executor(),
    const AxisFilter<P>& filter = {}
);

} // namespace raywise

#include <raywise/build/sweep.inl.hpp> // IWYU pragma: export
