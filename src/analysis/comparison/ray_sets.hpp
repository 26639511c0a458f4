// The rays that the variants of an area are asked about, and their answers.
#pragma once

#include <raywise/analysis/comparison.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/geometry/ray.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace raywise::detail {

using RaySets = std::vector<std::vector<Ray>>; ///< by seed, equally long
using HitSets = std::vector<std::vector<std::optional<Hit>>>;

/// The rays of the area number `index`; the same for any executor.
[[nodiscard]] RaySets draw_rays(
    const Distribution& distribution,
    std::size_t index,
    const CompareParams& params,
    const Executor& executor
);

/// The segments from where the rays end back to where they start: the shadow rays of a light that
/// emits them.
[[nodiscard]] RaySets shadow_rays(const RaySets& sets, const HitSets& hits);

/// The same triangle at the same t, or two misses.
[[nodiscard]] bool is_same_hit(const std::optional<Hit>& a, const std::optional<Hit>& b);

/// Rays whose hits differ.
[[nodiscard]] std::uint64_t count_differences(const HitSets& a, const HitSets& b);

} // namespace raywise::detail
