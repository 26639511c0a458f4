#include "analysis/comparison/area_comparison.hpp"
#include "analysis/comparison/area_runs.hpp"
#include "analysis/comparison/describe.hpp"
#include "analysis/comparison/full_run.hpp"
#include "analysis/comparison/protocol.hpp"
#include "analysis/comparison/ray_sets.hpp"
#include "analysis/comparison/tree_run.hpp"

#include <raywise/analysis/comparison.hpp>
#include <raywise/analysis/statistics.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/toplevel/accelerator.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace raywise::detail {

namespace {

/// What does not depend on the variant. Returns wrong answers of the global tree.
std::uint64_t summarize_area(AreaSummary& summary, const AreaRuns& runs) {
    const Bvh& tree = local_tree_of(runs.baseline).tree;
    summary.name = runs.area.name;
    summary.triangles = tree.prims.size();
    if (!tree.is_empty())
        summary.root_probability = hit_probability(runs.area.distribution, tree.root().box());
    summary.global_cost = confidence_95(runs.global.cost);
    summary.global_real_cost = confidence_95(runs.global.real);
    const BruteForceCheck check = check_by_brute_force(
        runs.input.scene.view(),
        runs.sets,
        runs.global.hits,
        runs.input.params.brute_force_budget,
        runs.input.executor
    );
    summary.checked_by_brute_force = check.rays;
    return check.wrong;
}

/// The whole structure over all sets: what became of the rays, and what they cost.
FullRun run_whole(ComparisonRow& row, const AreaRuns& runs, const Accelerator& accelerator) {
    FullRun all;
    std::vector<double> costs;
    for (const FullRun& of_set : run_full(
             accelerator, runs.sets, runs.global, runs.input.params.constants, runs.input.executor
         )) {
        all += of_set;
        costs.push_back(of_set.cost / static_cast<double>(of_set.rays));
    }
    row.full_cost = confidence_95(costs);
    row.full_ratio = ratio_of(costs, runs.global.cost);
    return all;
}

ComparisonRow compare_variant(
    Variant variant,
    const AreaRuns& runs,
    const Accelerator& accelerator,
    AreaSummary& summary
) {
    const CompareParams& params = runs.input.params;
    const Executor& executor = runs.input.executor;
    ComparisonRow row;
    row.area = runs.input.index;
    row.variant = variant;
    row.is_baseline = variant == baseline_of(params);
    describe_tree(row, runs, accelerator);

    const TreeRun own =
        row.is_baseline
            ? TreeRun{}
            : run_tree(local_tree_of(accelerator), runs.sets, params.constants, executor);
    const TreeRun& run = row.is_baseline ? runs.local : own;
    describe_costs(row, runs, run);

    const FullRun full = run_whole(row, runs, accelerator);
    describe_break_even(row, runs, run, full);
    const ShadowRun shadows = run_shadows(accelerator, runs.shadows, params.constants, executor);
    row.shadow_ratio = ratio_of(shadows.full, shadows.global);
    if (params.faithful) {
        row.wrong_fraction = static_cast<double>(full.wrong) / static_cast<double>(full.rays);
    } else {
        row.mismatches = count_differences(run.hits, runs.local.hits) +
                         std::accumulate(shadows.wrong.begin(), shadows.wrong.end(), full.wrong);
    }
    if (row.is_baseline) describe_service(summary, full);
    if (params.repeats > 0) time_variant(row, summary, runs, accelerator);
    return row;
}

/// The winner by counts, which no busy machine can bend; judged by time where there is one.
/// Choosing by time as well would pick the luckiest and believe it.
void decide(AreaResult& result, const CompareParams& params) {
    const auto best = std::min_element(
        result.rows.begin(),
        result.rows.end(),
        [](const ComparisonRow& a, const ComparisonRow& b) {
            return a.full_ratio.mean < b.full_ratio.mean;
        }
    );
    result.summary.winner = static_cast<std::size_t>(best - result.rows.begin());
    const ConfidenceInterval judged = params.repeats > 0 ? best->full_ns_ratio : best->full_ratio;
    using Verdict = AreaSummary::Verdict;
    result.summary.verdict = judged.high() < 1  ? Verdict::local_structure
                             : judged.low() > 1 ? Verdict::global_tree
                                                : Verdict::no_difference;
}

} // namespace

AreaResult compare_area(const AreaInput& input) {
    const CompareParams& params = input.params;
    const AreaRuns runs = run_baseline(input);
    AreaResult result;
    const std::uint64_t wrong = summarize_area(result.summary, runs);
    for (const Variant variant : params.variants) {
        if (variant == baseline_of(params)) {
            result.rows.push_back(compare_variant(variant, runs, runs.baseline, result.summary));
        } else {
            const Accelerator other = runs.baseline.with_local_heuristic(
                local_heuristic(variant, params), input.scene.view(), input.executor, input.progress
            );
            result.rows.push_back(compare_variant(variant, runs, other, result.summary));
        }
        input.progress.step(
            "compare " + runs.area.name, result.rows.size(), params.variants.size()
        );
    }
    result.rows.front().mismatches += wrong;
    decide(result, params);
    return result;
}

} // namespace raywise::detail
