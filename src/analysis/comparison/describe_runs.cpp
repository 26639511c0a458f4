#include "analysis/comparison/area_runs.hpp"
#include "analysis/comparison/describe.hpp"
#include "analysis/comparison/full_run.hpp"
#include "analysis/comparison/tree_run.hpp"

#include <raywise/analysis/break_even.hpp>
#include <raywise/analysis/comparison.hpp>
#include <raywise/analysis/estimated_cost.hpp>
#include <raywise/analysis/statistics.hpp>

#include <cstddef>
#include <cstdint>

namespace raywise::detail {

void describe_costs(ComparisonRow& row, const AreaRuns& runs, const TreeRun& run) {
    row.real_cost = confidence_95(run.real);
    row.estimate_error = estimate_error(row.real_cost.mean, row.estimated_cost);
    row.estimate_error_sah = estimate_error(row.real_cost.mean, row.estimated_cost_sah);
    row.hits_per_ray = confidence_95(run.hits_per_ray);
    row.box_tests = confidence_95(run.box_tests);
    row.node_visits = confidence_95(run.node_visits);
    row.prim_tests = confidence_95(run.prim_tests);
    row.ordered_cost = confidence_95(run.cost);
    row.ordered_cost_median = median(run.every_cost);
    row.ordered_cost_percentile_95 = percentile(run.every_cost, 95);
    row.any_hit_cost = confidence_95(run.any_cost);
    row.ordered_ratio = ratio_of(run.cost, runs.local.cost);
    row.ns_ratio = {1, 0};
    row.full_ns_ratio = {1, 0};
}

void describe_break_even(
    ComparisonRow& row,
    const AreaRuns& runs,
    const TreeRun& run,
    const FullRun& full
) {
    double restarts = 0;
    double restart_cost = 0;
    for (std::size_t s = 0; s < run.hits.size(); ++s) {
        for (std::size_t i = 0; i < run.hits[s].size(); ++i) {
            if (run.hits[s][i]) continue;
            ++restarts;
            restart_cost += runs.global.every_real[s][i];
        }
    }
    row.restart_cost = row.real_cost.mean + restart_cost / static_cast<double>(full.rays);
    if (runs.input.params.faithful) { // the thesis's rule, in its own unpruned unit
        row.break_even_hit_fraction = break_even_hit_fraction(
            {.local = row.real_cost.mean,
             .continuation = restarts > 0 ? restart_cost / restarts : 0,
             .global = mean(runs.global.real)}
        );
    } else if (full.searched > 0) {
        const auto searched = static_cast<double>(full.searched);
        const auto continued = static_cast<double>(full.continued);
        row.break_even_hit_fraction = break_even_hit_fraction(
            {.local = full.local_cost / searched,
             .continuation = continued > 0 ? full.continuation_cost / continued : 0,
             .global = full.global_alone_cost / searched}
        );
    }
}

void describe_service(AreaSummary& summary, const FullRun& full) {
    const auto share = [](std::uint64_t part, std::uint64_t whole) {
        return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
    };
    summary.hit_fraction = share(full.hits, full.rays);
    summary.answered_fraction = share(full.answered, full.rays);
    summary.local_hit_fraction = share(full.local_hits, full.rays);
    summary.continuation_fraction = share(full.continued, full.rays);
    summary.continuation_hit_fraction = share(full.continued_hits, full.continued);
    if (full.continued > 0)
        summary.continuation_cost = full.continuation_cost / static_cast<double>(full.continued);
}

} // namespace raywise::detail
