// Whether answers are right: those of every ray, judged by the exact oracle.
#pragma once

#include <raywise/analysis/exact_oracle.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <cstddef>
#include <span>

namespace raywise {

/// What a tracer that promises nothing exact is held to: the triangle may be another one that the
/// ray meets at nearly the same place, and t may be off by this share of itself, or of the longest
/// coordinate of the hit point where the ray is long against its t.
inline constexpr double loose_tolerance = 1e-4;

/// The number of rays whose closest hit is not (t, prim) of the oracle, bit for bit. Throws Error
/// when the sizes differ.
[[nodiscard]] std::size_t count_wrong_hits(
    const ExactOracle& oracle,
    std::span<const Ray> rays,
    std::span<const Hit> hits,
    const Executor& executor = serial_executor()
);

/// The number of rays for which `occluded` says the opposite of the oracle.
[[nodiscard]] std::size_t count_wrong_occlusions(
    const ExactOracle& oracle,
    std::span<const Ray> rays,
    std::span<const bool> occluded,
    const Executor& executor = serial_executor()
);

/// The number of rays whose closest hit is not that of the oracle within `loose_tolerance` in t:
/// for tracers that compute in floats. A hit instead of a miss, or the reverse, is always wrong.
[[nodiscard]] std::size_t count_grossly_wrong_hits(
    const ExactOracle& oracle,
    std::span<const Ray> rays,
    std::span<const Hit> hits,
    const Executor& executor = serial_executor()
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
