#include "analysis/comparison/area_comparison.hpp"
#include "analysis/comparison/area_runs.hpp"
#include "analysis/comparison/describe.hpp"
#include "analysis/comparison/protocol.hpp"

#include <raywise/analysis/comparison.hpp>
#include <raywise/analysis/end_point_overlap.hpp>
#include <raywise/analysis/estimated_cost.hpp>
#include <raywise/analysis/memory.hpp>
#include <raywise/analysis/overlap.hpp>
#include <raywise/analysis/statistics.hpp>
#include <raywise/analysis/stopwatch.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/bvh/statistics.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/distribution/ray_distribution.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/build_tree.hpp>
#include <raywise/toplevel/membership.hpp>

#include <algorithm>
#include <cstddef>
#include <variant>
#include <vector>

namespace raywise::detail {

namespace {

double estimate(
    const Bvh& tree,
    const Distribution& distribution,
    MeasureMode mode,
    const CostConstants& constants
) {
    const auto with = [&](const auto& measure) {
        return estimate_cost(tree, measure, Normalization::absolute, constants).total();
    };
    if (const auto* radial = std::get_if<RadialDistribution>(&distribution))
        return with(radial->measure(mode));
    return std::visit([&](const auto& chosen) { return with(chosen.measure()); }, distribution);
}

void describe_shape(ComparisonRow& row, const Accelerator& accelerator) {
    const auto& [tree, triangles] = local_tree_of(accelerator);
    const TreeStatistics shape = measure_tree(tree);
    row.triangles = shape.references;
    row.nodes = shape.nodes;
    row.leaves = shape.leaves;
    row.depth = shape.max_depth;
    row.memory = measure_memory(tree);
    const AcceleratorMemory whole = accelerator.measure_memory();
    row.memory.triangles = triangles.size_in_bytes();
    row.memory.areas = whole.areas;
    row.memory.index = whole.index;
}

/// The work of the build, and its time when times are wanted: members, boxes and tree.
void describe_build(ComparisonRow& row, const AreaRuns& runs) {
    const AreaInput& input = runs.input;
    const CompareParams& params = input.params;
    const TriangleView triangles = input.scene.view();
    if (params.repeats == 0 && !params.faithful) return;
    // Short builds are repeated, long ones speak for themselves.
    constexpr double enough_ms = 500;
    const auto most = static_cast<std::size_t>(std::max(params.repeats, 1));
    std::vector<double> times;
    for (double spent = 0; times.size() < most && spent < enough_ms; spent += times.back()) {
        const Stopwatch watch;
        const std::vector<PrimId> members =
            members_of(triangles, runs.area.region, membership_of(params), input.executor);
        const BuiltTree built = build_tree(
            build_input_of(triangles, members, input.executor),
            runs.area.distribution,
            local_heuristic(row.variant, params),
            input.executor
        );
        times.push_back(watch.milliseconds());
        row.build_work = built.report;
    }
    if (params.repeats > 0) row.build_ms = median(times);
}

} // namespace

void describe_tree(ComparisonRow& row, const AreaRuns& runs, const Accelerator& accelerator) {
    const AreaInput& input = runs.input;
    const CompareParams& params = input.params;
    const Distribution& rays = runs.area.distribution;
    const Bvh& tree = local_tree_of(accelerator).tree;
    const MeasureMode mode = params.faithful ? MeasureMode::thesis : MeasureMode::exact;
    describe_shape(row, accelerator);
    row.estimated_cost = estimate(tree, rays, mode, params.constants);
    row.estimated_cost_sah =
        estimate_cost(tree, SurfaceMeasure{}, Normalization::conditional, params.constants).total();
    const auto culled = measure_overlap(tree, rays, Culling::culled, mode);
    row.overlap =
        (culled ? *culled : measure_overlap(tree, runs.sets.front(), input.executor)).all();
    const auto unculled = measure_overlap(tree, rays, Culling::unculled, mode);
    row.overlap_unculled = unculled ? unculled->all() : row.overlap;
    constexpr std::size_t overlap_sample = 10'000; // triangles: an error of about a percent
    row.end_point_overlap = measure_end_point_overlap(
        tree, input.scene.view(), params.constants, input.executor, overlap_sample
    );
    describe_build(row, runs);
}

} // namespace raywise::detail
