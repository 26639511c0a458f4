#include "analysis/comparison/area_comparison.hpp"
#include "analysis/comparison/area_runs.hpp"
#include "analysis/comparison/protocol.hpp"
#include "analysis/comparison/ray_sets.hpp"
#include "analysis/comparison/tree_run.hpp"

#include <raywise/analysis/statistics.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/toplevel/accelerator.hpp>

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace raywise::detail {

AreaRuns run_baseline(const AreaInput& input) {
    const auto& [scene, plain_area, index, params, executor, progress] = input;
    InfluenceArea area = prepared(plain_area, params);
    RaySets sets = draw_rays(area.distribution, index, params, executor);
    Accelerator baseline =
        build_accelerator(scene, {area}, baseline_structure(params), executor, progress);
    TreeRun global = run_tree(global_tree_of(baseline), sets, params.constants, executor);
    TreeRun local = run_tree(local_tree_of(baseline), sets, params.constants, executor);
    RaySets shadows = shadow_rays(sets, global.hits);
    return {
        input,
        std::move(area),
        std::move(sets),
        std::move(baseline),
        std::move(global),
        std::move(local),
        std::move(shadows)
    };
}

ConfidenceInterval ratio_of(std::span<const double> candidate, std::span<const double> baseline) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < candidate.size() && i < baseline.size(); ++i) {
        if (candidate[i] > 0 && baseline[i] > 0) ratios.push_back(candidate[i] / baseline[i]);
    }
    return ratios.empty() ? ConfidenceInterval{1, 0} : confidence_95_of_ratios(ratios);
}

} // namespace raywise::detail
