#include "analysis/comparison/area_runs.hpp"
#include "analysis/comparison/describe.hpp"
#include "analysis/comparison/paired_timing.hpp"

#include <raywise/analysis/break_even.hpp>
#include <raywise/analysis/comparison.hpp>
#include <raywise/analysis/statistics.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/traced_tree.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raywise::detail {

namespace {

/// The four queries that are timed side by side.
enum Timed : std::uint8_t { baseline_tree, own_tree, global_tree, whole };

std::uint64_t trace_tree(const BinaryTree& traced, std::span<const Ray> rays) {
    return trace_all(rays, [&](const Ray& ray) {
        return closest_hit(traced.tree, traced.triangles, ray);
    });
}

} // namespace

void time_variant(
    ComparisonRow& row,
    AreaSummary& summary,
    const AreaRuns& runs,
    const Accelerator& accelerator
) {
    const CompareParams& params = runs.input.params;
    const auto trace_baseline = [&](std::span<const Ray> rays) {
        return trace_tree(local_tree_of(runs.baseline), rays);
    };
    const auto trace_own = [&](std::span<const Ray> rays) {
        return trace_tree(local_tree_of(accelerator), rays);
    };
    const auto trace_global = [&](std::span<const Ray> rays) {
        return trace_tree(global_tree_of(runs.baseline), rays);
    };
    const auto trace_whole = [&](std::span<const Ray> rays) {
        return trace_all(rays, [&](const Ray& ray) { return accelerator.closest_hit(ray); });
    };
    const std::array<TimedPass, 4> passes{trace_baseline, trace_own, trace_global, trace_whole};
    std::array<std::vector<double>, 4> ns;
    for (const std::vector<Ray>& set : runs.sets) {
        const auto rays = std::span(set).first(std::min(set.size(), params.timed_rays));
        std::vector<std::uint64_t> sums;
        const std::vector<double> medians = time_interleaved(passes, rays, params.repeats, sums);
        for (std::size_t i = 0; i < ns.size(); ++i)
            ns[i].push_back(medians[i]);
        const bool is_same =
            sums[baseline_tree] == sums[own_tree] && sums[global_tree] == sums[whole];
        if (!params.faithful && !is_same) ++row.mismatches;
    }
    row.ns_per_ray = confidence_95(ns[own_tree]);
    row.ns_ratio =
        row.is_baseline ? ConfidenceInterval{1, 0} : ratio_of(ns[own_tree], ns[baseline_tree]);
    row.full_ns = confidence_95(ns[whole]);
    row.full_ns_ratio = ratio_of(ns[whole], ns[global_tree]);
    row.break_even_rays =
        break_even_rays(row.build_ms * 1e6, mean(ns[global_tree]), row.full_ns.mean);
    if (row.is_baseline) summary.global_ns = confidence_95(ns[global_tree]);
}

} // namespace raywise::detail
