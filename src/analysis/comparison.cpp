#include <raywise/analysis/comparison.hpp>

#include "analysis/comparison/area_comparison.hpp"
#include "analysis/comparison/protocol.hpp"

#include <raywise/analysis/memory.hpp>
#include <raywise/analysis/statistics.hpp>
#include <raywise/analysis/stopwatch.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/statistics.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/area_id.hpp>
#include <raywise/toplevel/build_tree.hpp>
#include <raywise/toplevel/region_list.hpp>
#include <raywise/toplevel/region_octree.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace raywise {

namespace {

void check(const Scene& scene, std::span<const InfluenceArea> areas, const CompareParams& params) {
    if (scene.triangles.empty()) throw Error("compare: the scene has no triangles");
    if (areas.empty()) throw Error("compare: there is no influence area");
    if (params.rays < 1 || params.rays > 100'000'000) {
        throw Error("compare: rays must be in [1, 10^8]");
    }
    if (params.seeds < 1 || params.seeds > 1000) throw Error("compare: seeds must be in [1, 1000]");
    if (params.repeats < 0 || params.repeats > 1000) {
        throw Error("compare: repeats must be in [0, 1000]");
    }
    if (params.timed_rays < 1) throw Error("compare: timed_rays must be at least 1");
    if (!(params.brute_force_budget >= 0)) {
        throw Error("compare: the brute force budget must be at least 0");
    }
    if (!(params.constants.node > 0 && params.constants.prim > 0)) {
        throw Error("compare: cost constants must be positive");
    }
    if (params.faithful &&
        std::any_of(params.variants.begin(), params.variants.end(), [](Variant v) {
            return v.axes == Variant::Axes::all ||
                   (v.measure != Variant::Measure::surface && v.measure != Variant::Measure::area);
        })) {
        throw Error("compare: a faithful run knows SAH and PAH by longest and facing axes only");
    }
}

CompareParams with_baseline(CompareParams params) {
    const Variant baseline = detail::baseline_of(params);
    if (std::find(params.variants.begin(), params.variants.end(), baseline) ==
        params.variants.end()) {
        params.variants.insert(params.variants.begin(), baseline);
    }
    return params;
}

/// Nanoseconds per point query, and the number of areas found so that the work is not left out.
template <class Index>
double time_queries(const Index& index, std::span<const Vec3> points, std::size_t& found) {
    const Stopwatch watch;
    for (const Vec3 point : points)
        index.visit_areas_at(point, [&](AreaId) { ++found; });
    return watch.nanoseconds() / static_cast<double>(points.size());
}

IndexSummary summarize_index(std::span<const InfluenceArea> areas, const CompareParams& params) {
    std::vector<Region> regions;
    for (const InfluenceArea& area : areas)
        regions.push_back(area.region);
    const Stopwatch build;
    const RegionOctree octree(regions);
    const double build_ms = build.milliseconds();
    const OctreeStatistics shape = octree.measure_statistics();
    IndexSummary summary;
    summary.areas = areas.size();
    summary.octree_nodes = shape.nodes;
    summary.octree_leaves = shape.leaves;
    summary.octree_depth = std::max(shape.levels - 1, 0);
    summary.octree_mean_list = shape.mean_list_length;
    summary.octree_max_list = shape.max_list_length;
    summary.octree_bytes = shape.bytes;
    if (params.repeats == 0) return summary;

    constexpr std::size_t queries = 4096;
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < queries; ++i) {
        Rng rng(params.seed, i);
        points.push_back(sample(areas[i % areas.size()].distribution, rng).origin);
    }
    const RegionList list(regions);
    std::vector<double> list_ns;
    std::vector<double> octree_ns;
    std::size_t by_list = 0;
    std::size_t by_octree = 0;
    for (int i = 0; i < params.repeats; ++i) {
        list_ns.push_back(time_queries(list, points, by_list));
        octree_ns.push_back(time_queries(octree, points, by_octree));
    }
    if (by_list != by_octree) throw Error("compare: list and octree disagree about the areas");
    summary.octree_build_ms = build_ms;
    summary.list_ns = median(list_ns);
    summary.octree_ns = median(octree_ns);
    return summary;
}

std::vector<VariantSummary> summarize_variants(const Comparison& comparison) {
    std::vector<VariantSummary> summaries;
    for (const Variant variant : comparison.params.variants) {
        std::vector<double> ordered;
        std::vector<double> full;
        VariantSummary summary{.variant = variant};
        for (const ComparisonRow& row : comparison.rows) {
            if (row.variant != variant) continue;
            ordered.push_back(row.ordered_ratio.mean);
            full.push_back(row.full_ratio.mean);
            if (row.full_ratio.high() < 1) ++summary.wins;
        }
        summary.ordered_ratio = geometric_mean(ordered);
        summary.full_ratio = geometric_mean(full);
        summaries.push_back(summary);
    }
    return summaries;
}

void describe_global(Comparison& comparison, const Scene& scene, const Executor& executor) {
    const Heuristic heuristic = detail::global_heuristic(comparison.params);
    const Stopwatch watch;
    const Bvh tree = build_tree(build_input_of(scene.view(), executor), heuristic, executor).tree;
    if (comparison.params.repeats > 0) comparison.global_build_ms = watch.milliseconds();
    const TreeStatistics shape = measure_tree(tree);
    comparison.global_nodes = shape.nodes;
    comparison.global_depth = shape.max_depth;
    comparison.global_memory = measure_memory(tree);
    comparison.global_memory.triangles = tree.prims.size() * sizeof(Triangle);
}

} // namespace

std::string name_of(Variant variant) {
    const auto measure = [&] {
        switch (variant.measure) {
        case Variant::Measure::surface:
            return "SAH";
        case Variant::Measure::area:
            return "PAH";
        case Variant::Measure::mixed:
            return "PAH+SAH";
        case Variant::Measure::counted:
            return "RAYS";
        }
        return "";
    };
    const auto axes = [&] {
        switch (variant.axes) {
        case Variant::Axes::longest:
            return "/longest";
        case Variant::Axes::facing:
            return "/facing";
        case Variant::Axes::all:
            return "/all";
        }
        return "";
    };
    return std::string(measure()) + axes();
}

std::vector<Variant> default_variants() {
    using Measure = Variant::Measure;
    using Axes = Variant::Axes;
    std::vector<Variant> variants;
    for (const Measure measure : {Measure::surface, Measure::area}) {
        for (const Axes axes : {Axes::all, Axes::longest, Axes::facing}) {
            variants.push_back({measure, axes});
        }
    }
    variants.push_back({Measure::mixed, Axes::all});
    variants.push_back({Measure::counted, Axes::all});
    return variants;
}

std::vector<Variant> faithful_variants() {
    using Measure = Variant::Measure;
    using Axes = Variant::Axes;
    return {
        {Measure::area, Axes::facing},
        {Measure::surface, Axes::facing},
        {Measure::area, Axes::longest},
        {Measure::surface, Axes::longest}
    };
}

CompareParams faithful_params() {
    CompareParams params;
    params.variants = faithful_variants();
    params.rays = 1000;
    params.seeds = 1;
    params.repeats = 0;
    params.faithful = true;
    return params;
}

std::string verdict_text(const Comparison& comparison, std::size_t area) {
    const AreaSummary& summary = comparison.areas.at(area);
    const ComparisonRow& winner = comparison.rows.at(summary.winner);
    const auto share = [](ConfidenceInterval ratio) {
        std::array<char, 64> figure{};
        std::snprintf(figure.data(), figure.size(), "%.3f", ratio.mean);
        std::string text = figure.data();
        if (!std::isfinite(ratio.half_width)) return text;
        std::snprintf(figure.data(), figure.size(), " +- %.3f", ratio.half_width);
        return text + figure.data();
    };
    std::string takes = "takes " + share(winner.full_ratio) + " of the cost";
    if (comparison.params.repeats > 0)
        takes += " and " + share(winner.full_ns_ratio) + " of the time";
    takes += " of the global BVH alone";
    const std::string name = name_of(winner.variant);
    switch (summary.verdict) {
    case AreaSummary::Verdict::local_structure:
        return "use " + name + ": it " + takes;
    case AreaSummary::Verdict::global_tree:
        return "use the global BVH: the best, " + name + ", " + takes;
    case AreaSummary::Verdict::no_difference:
        break;
    }
    return "use the global BVH, there is no clear difference: the best, " + name + ", " + takes;
}

Comparison compare(
    const Scene& scene,
    std::span<const InfluenceArea> areas,
    const CompareParams& params,
    const Executor& executor,
    const Progress& progress
) {
    check(scene, areas, params);
    Comparison comparison;
    comparison.scene = scene.name;
    comparison.scene_hash = content_hash(scene);
    comparison.triangles = scene.triangles.size();
    comparison.degenerate_triangles = count_degenerate(scene);
    comparison.params = with_baseline(params);
    describe_global(comparison, scene, executor);
    comparison.index = summarize_index(areas, comparison.params);
    for (std::size_t i = 0; i < areas.size(); ++i) {
        detail::AreaResult result = detail::compare_area(
            {.scene = scene,
             .area = areas[i],
             .index = i,
             .params = comparison.params,
             .executor = executor,
             .progress = progress}
        );
        result.summary.winner += comparison.rows.size();
        for (const ComparisonRow& row : result.rows)
            comparison.mismatches += row.mismatches;
        comparison.rows.insert(comparison.rows.end(), result.rows.begin(), result.rows.end());
        comparison.areas.push_back(std::move(result.summary));
    }
    comparison.variants = summarize_variants(comparison);
    return comparison;
}

} // namespace raywise
