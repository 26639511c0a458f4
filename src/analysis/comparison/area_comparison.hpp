// One influence area's part of a comparison.
#pragma once

#include <raywise/analysis/comparison.hpp>

#include <cstddef>
#include <vector>

namespace raywise::detail {

struct AreaInput {
    const Scene& scene;
    const InfluenceArea& area;
    std::size_t index = 0;       ///< among the areas
    const CompareParams& params; ///< checked, baseline included
    const Executor& executor;
    const Progress& progress;
};

struct AreaResult {
    AreaSummary summary;
    std::vector<ComparisonRow> rows; ///< in the order of the variants
};

/// Builds every variant over the area's triangles, draws the area's rays, verifies, counts, times.
[[nodiscard]] AreaResult compare_area(const AreaInput& input);

} // namespace raywise::detail
