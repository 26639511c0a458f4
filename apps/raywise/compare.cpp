// raywise compare: which heuristic and which structure is best for the rays of each area.
#include "area_source.hpp"
#include "comparison_report.hpp"
#include "exit_code.hpp"
#include "heat_maps.hpp"
#include "scene_source.hpp"
#include "session.hpp"

#include <raywise/analysis/comparison.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/nearest_word.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/io/report.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/build_tree.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace raywise::app {

namespace {

struct CompareOptions {
    SceneOptions source;
    std::string areas_file;
    std::string pairs;
    std::string heat_maps;
    std::size_t rays = CompareParams{}.rays;
    int seeds = CompareParams{}.seeds;
    int repeats = CompareParams{}.repeats;
    bool faithful = false;
    CLI::Option* rays_option = nullptr;
    CLI::Option* seeds_option = nullptr;
    CLI::Option* repeats_option = nullptr;
};

// Bytes per triangle of the global tree, the tree at work and their copies of the triangles; per
// ray with its counts, costs and answers.
constexpr std::uint64_t bytes_per_triangle = 600;
constexpr std::uint64_t bytes_per_ray = 400;

/// Every pair that has a name.
std::vector<Variant> known_variants() {
    std::vector<Variant> variants;
    for (const auto measure :
         {MeasureKind::surface, MeasureKind::area, MeasureKind::mixed, MeasureKind::counted})
        for (const auto axes : {AxisChoice::longest, AxisChoice::facing, AxisChoice::all})
            variants.push_back({measure, axes});
    return variants;
}

/// "SAH/all,PAH/facing" as variants. Throws UsageError for a name that there is not.
std::vector<Variant> parse_pairs(const std::string& text) {
    const std::vector<Variant> known = known_variants();
    std::vector<std::string> names;
    names.reserve(known.size());
    for (const Variant variant : known)
        names.push_back(name_of(variant));
    std::vector<Variant> pairs;
    std::istringstream stream(text);
    for (std::string name; std::getline(stream, name, ',');) {
        const auto at = std::find(names.begin(), names.end(), name);
        if (at == names.end())
            throw UsageError(fmt::format(
                "--pairs: unknown pair '{}'{} (a pair is SAH, PAH, PAH+SAH or RAYS, then /longest, "
                "/facing or /all)",
                name,
                did_you_mean(name, names)
            ));
        pairs.push_back(known[static_cast<std::size_t>(at - names.begin())]);
    }
    if (pairs.empty()) throw UsageError("--pairs names no pair");
    return pairs;
}

/// The thesis's protocol has rays, seeds and repeats of its own; options that are given go before
/// it.
CompareParams params_of(const CompareOptions& options, const Session& session) {
    CompareParams params = options.faithful ? faithful_params() : CompareParams{};
    if (options.rays_option->count() > 0) params.rays = options.rays;
    if (options.seeds_option->count() > 0) params.seeds = options.seeds;
    if (options.repeats_option->count() > 0) params.repeats = options.repeats;
    if (!options.pairs.empty()) params.variants = parse_pairs(options.pairs);
    params.seed = static_cast<std::uint64_t>(session.options.seed);
    return params;
}

void compare_areas(const CompareOptions& options, const Session& session) {
    const CompareParams params = params_of(options, session);
    const Scene scene = open_scene(options.source, session);
    const std::vector<InfluenceArea> areas = open_areas(options.areas_file, scene, session);
    require_memory(
        options.source,
        scene.triangles.size() * bytes_per_triangle +
            params.rays * static_cast<std::uint64_t>(params.seeds) * bytes_per_ray,
        "comparing"
    );
    const Executor executor = session.executor();
    const Progress progress = session.progress();
    const Comparison comparison = compare(scene, areas, params, executor, progress);

    if (!options.heat_maps.empty()) {
        const auto images = draw_heat_maps(scene, areas, comparison.params, executor, progress);
        session.put_files([&] { write_images(options.heat_maps, images); });
        session.console.message(fmt::format("{}: {} pictures", options.heat_maps, images.size()));
    }
    Report report =
        report_of(comparison, report_format(session.options.format), session.provenance());
    report.provenance.scene = scene_title(options.source);
    session.put_report(report, session.options.output);
    if (comparison.mismatches > 0)
        throw CheckFailed(fmt::format(
            "{} answers differ from those of the global tree or of brute force",
            comparison.mismatches
        ));
}

} // namespace

Command add_compare(CLI::App& root, CommonOptions& options) {
    CLI::App* app = root.add_subcommand(
        "compare", "Find which heuristic and structure is best for the rays of each area"
    );
    const auto own = std::make_shared<CompareOptions>();
    add_scene_options(*app, own->source);
    add_area_options(*app, own->areas_file);
    app->add_option(
        "--pairs",
        own->pairs,
        "Pairs to compare, such as SAH/all,PAH/facing; without it a standard set"
    );
    own->rays_option = app->add_option("--rays", own->rays, "Rays per area and seed")
                           ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}))
                           ->capture_default_str();
    own->seeds_option =
        app->add_option(
               "--seeds", own->seeds, "Independent sets of rays; at least two for intervals"
        )
            ->check(CLI::Range(1, 1000))
            ->capture_default_str();
    own->repeats_option =
        app->add_option("--repeats", own->repeats, "Timed passes per pair and seed; 0: counts only")
            ->check(CLI::Range(0, 1000))
            ->capture_default_str();
    app->add_flag(
        "--faithful", own->faithful, "The thesis's builders, rays, membership and thresholds"
    );
    app->add_option(
        "--heat-maps", own->heat_maps, "Write pictures of the cost of each ray into this folder"
    );
    add_common_options(*app, options, "Write the report to this file");
    return {app, {}, [own](const Session& session) { compare_areas(*own, session); }};
}

} // namespace raywise::app
