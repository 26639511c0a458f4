// Whether answers are right: those of every ray, beside the answers of the exact oracle.
#pragma once

#include <raywise/analysis/exact_oracle.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <cstddef>
#include <span>

namespace raywise {

/// The number of rays whose closest hit is not the right (t, prim), bit for bit. Throws Error when
/// the sizes differ, as the other functions here.
[[nodiscard]] std::size_t count_wrong(std::span<const Hit> right, std::span<const Hit> found);

/// The number of rays whose occlusion is not the right one.
[[nodiscard]] std::size_t count_wrong(std::span<const bool> right, std::span<const bool> found);

/// For tracers that compute in floats and promise nothing exact: the number of rays whose closest
/// hit lies more than `tolerance` (> 0) away from the right one, as a share of t or, where that is
/// more, of the largest coordinate that the ray's arithmetic meets. A hit instead of a miss, or the
/// reverse, is always wrong; another triangle at the same place is not.
[[nodiscard]] std::size_t count_far_off(
    std::span<const Ray> rays,
    std::span<const Hit> right,
    std::span<const Hit> found,
    double tolerance = 1e-4
);

/// The number of the oracle's own answers, out of `samples` rays spread over all, that brute force
/// over the triangles contradicts. O(samples x triangles).
[[nodiscard]] std::size_t count_wrong_oracle_answers(
    const ExactOracle& oracle,
    const TriangleView& triangles,
    std::span<const Ray> rays,
    std::size_t samples,
    const Executor& executor = serial_executor()
);

} // namespace raywise
