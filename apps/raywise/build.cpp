// raywise build: one tree over all triangles, for uniform rays or for those of an area.
#include "area_source.hpp"
#include "exit_code.hpp"
#include "heuristic_options.hpp"
#include "scene_source.hpp"
#include "session.hpp"

#include <raywise/analysis/estimated_cost.hpp>
#include <raywise/analysis/stopwatch.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/statistics.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/io/report.hpp>
#include <raywise/io/tree_file.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/build_tree.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace raywise::app {

namespace {

struct BuildOptions {
    SceneOptions source;
    HeuristicOptions heuristic;
    std::string areas_file;
    std::string area;
};

// Bytes per triangle while a tree is built: boxes, centroids, working copies of both, nodes and
// ids.
constexpr std::uint64_t build_bytes_per_triangle = 256;

/// The area whose rays the tree is for; nothing for surface area without facing axes.
std::optional<InfluenceArea>
choose_area(const BuildOptions& options, const Scene& scene, const Session& session) {
    const bool needs_area =
        options.heuristic.measure != "sah" || options.heuristic.axes == "facing";
    if (!needs_area && options.area.empty()) return std::nullopt;
    const std::vector<InfluenceArea> areas = open_areas(options.areas_file, scene, session);
    if (!options.area.empty()) return find_area(areas, options.area);
    if (areas.size() == 1) return areas.front();
    std::vector<std::string> names;
    names.reserve(areas.size());
    for (const InfluenceArea& area : areas)
        names.push_back(area.name);
    throw UsageError(fmt::format("--area is needed, one of: {}", fmt::join(names, ", ")));
}

/// Expected cost of an emitted ray of the area.
double area_cost(const Bvh& tree, const InfluenceArea& area) {
    return std::visit(
        [&](const auto& measure) {
            return estimate_cost(tree, measure, Normalization::absolute).total();
        },
        measure_of(area.distribution)
    );
}

Report describe(
    const Bvh& tree,
    const std::optional<InfluenceArea>& area,
    const HeuristicOptions& heuristic,
    double build_ms
) {
    const TreeStatistics statistics = measure_tree(tree);
    Report report;
    report.title = "Tree";
    ReportTable& table = report.table;
    add_fact(table, "measure", heuristic.measure);
    add_fact(table, "axes", heuristic.axes);
    add_fact(table, "builder", heuristic.builder);
    if (area) add_fact(table, "area", area->name);
    add_count(table, "nodes", statistics.nodes);
    add_count(table, "leaves", statistics.leaves);
    add_count(table, "references", statistics.references);
    add_fact(table, "max_depth", std::int64_t{statistics.max_depth});
    add_fact(table, "mean_leaf_depth", statistics.mean_leaf_depth);
    add_count(table, "largest_leaf_triangles", statistics.largest_leaf);
    add_count(table, "tree_bytes", statistics.bytes);
    add_fact(
        table,
        "estimated_cost_sah",
        estimate_cost(tree, SurfaceMeasure{}, Normalization::conditional).total()
    );
    if (area) add_fact(table, "estimated_cost_area", area_cost(tree, *area));
    add_fact(table, "build_ms", build_ms);
    return report;
}

void build(const BuildOptions& options, const Session& session) {
    const Scene scene = open_scene(options.source, session);
    require_memory(
        options.source, scene.triangles.size() * build_bytes_per_triangle, "building the tree"
    );
    const std::optional<InfluenceArea> area = choose_area(options, scene, session);
    const Heuristic heuristic = heuristic_of(options.heuristic);
    const Executor executor = session.executor();
    const Progress progress = session.progress();
    const std::uint64_t triangles = scene.triangles.size();

    progress.step("building", 0, triangles);
    const Stopwatch stopwatch;
    const BuildInput input = build_input_of(scene.view(), executor);
    Bvh tree = area ? build_tree(input, area->distribution, heuristic, executor).tree
                    : build_tree(input, heuristic, executor).tree;
    const double build_ms = stopwatch.milliseconds();
    if (const auto fault = find_fault(tree, input.boxes))
        throw CheckFailed("the tree is broken: " + *fault);
    progress.step("building", triangles, triangles);

    const std::uint64_t hash = content_hash(scene);
    Report report = describe(tree, area, options.heuristic, build_ms);
    if (!session.options.output.empty())
        session.put_files([&] {
            save_tree(session.options.output, {std::move(tree), hash, scene.triangles.size()});
        });
    report.provenance = session.provenance();
    report.provenance.scene = scene_title(options.source);
    report.provenance.scene_hash = hash;
    report.provenance.normalization =
        "estimated_cost_sah per ray that hits the root, estimated_cost_area per emitted ray";
    session.put_report(report, {});
}

} // namespace

Command add_build(CLI::App& root, CommonOptions& options) {
    CLI::App* app = root.add_subcommand(
        "build", "Build one tree over all triangles; statistics, and a tree file"
    );
    const auto own = std::make_shared<BuildOptions>();
    add_scene_options(*app, own->source);
    add_heuristic_options(*app, own->heuristic);
    add_area_options(*app, own->areas_file);
    app->add_option("--area", own->area, "Name of the area whose rays the tree is for");
    add_common_options(*app, options, "Write the tree to this file (.rwtree)");
    return {app, {}, [own](const Session& session) { build(*own, session); }};
}

} // namespace raywise::app
