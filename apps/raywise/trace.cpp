// raywise trace: rays of a file, or drawn from the areas, and their hits.
#include "area_source.hpp"
#include "exit_code.hpp"
#include "scene_source.hpp"
#include "session.hpp"
#include "tracer.hpp"

#include <raywise/analysis/stopwatch.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/io/occlusion_file.hpp>
#include <raywise/io/ray_file.hpp>
#include <raywise/io/report.hpp>
#include <raywise/io/tree_file.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/trace/brute_force.hpp>
#include <raywise/trace/triangles.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace raywise::app {

namespace {

struct TraceOptions {
    SceneOptions source;
    std::string areas_file;
    std::string rays_file;
    std::string save_rays_file;
    std::string tree_file;
    std::uint64_t sample = 0; ///< rays per area, instead of a file
    std::uint64_t verify = 0; ///< rays checked by brute force
    bool any = false;
    bool fast = false;
};

// Bytes per triangle of a tree with its copy of the triangles, and per ray with its answer.
constexpr std::uint64_t bytes_per_triangle = 256;
constexpr std::uint64_t bytes_per_ray = 96;

std::vector<Ray> draw_rays(
    const TraceOptions& options,
    const std::vector<InfluenceArea>& areas,
    const Session& session
) {
    const auto seed = static_cast<std::uint64_t>(session.options.seed);
    require_memory(
        options.source, options.sample * areas.size() * bytes_per_ray, "drawing the rays"
    );
    std::vector<Ray> rays;
    rays.reserve(options.sample * areas.size());
    for (const InfluenceArea& area : areas)
        for (std::uint64_t i = 0; i < options.sample; ++i) {
            Rng stream(seed, rays.size());
            rays.push_back(sample(area.distribution, stream));
        }
    return rays;
}

/// The tree of the file, once it is known to be one of this scene.
SingleTree open_tree(const std::string& path, const Scene& scene) {
    TreeFile file = load_tree(path);
    if (file.scene_hash != content_hash(scene))
        throw Error(path, nowhere(), "the tree was built for another scene");
    if (const auto fault = find_fault(file.tree, triangle_boxes(scene)))
        throw Error(path, nowhere(), *fault);
    PackedTriangles triangles(file.tree, scene.view());
    return {std::move(file.tree), std::move(triangles)};
}

bool is_same(const std::optional<Hit>& a, const std::optional<Hit>& b) {
    return a.has_value() == b.has_value() && (!a || (a->t == b->t && a->prim == b->prim));
}

/// Asks every triangle about `count` rays spread over all of them. `is_right(i, hit)` compares.
template <class IsRight>
std::uint64_t count_mismatches(
    const Scene& scene,
    std::span<const Ray> rays,
    std::uint64_t count,
    const Progress& progress,
    const IsRight& is_right
) {
    std::uint64_t mismatches = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        progress.step("verifying by brute force", i, count);
        const std::size_t at = i * rays.size() / count;
        if (!is_right(at, brute_force_closest_hit(scene.view(), rays[at]))) ++mismatches;
    }
    return mismatches;
}

struct Outcome {
    std::size_t rays = 0;
    std::size_t hits = 0;
    std::uint64_t verified = 0;
    std::uint64_t mismatches = 0;
    double trace_ms = 0;
};

Outcome trace_closest(
    const TraceOptions& options,
    const Tracer& tracer,
    const Scene& scene,
    std::span<const Ray> rays,
    const Session& session
) {
    Outcome outcome{
        .rays = rays.size(), .verified = std::min<std::uint64_t>(options.verify, rays.size())
    };
    const Stopwatch stopwatch;
    const auto hits = closest_hits(tracer, rays, session.executor(), session.progress());
    outcome.trace_ms = stopwatch.milliseconds();
    for (const auto& hit : hits)
        outcome.hits += hit ? 1U : 0U;
    outcome.mismatches = count_mismatches(
        scene,
        rays,
        outcome.verified,
        session.progress(),
        [&](std::size_t i, const std::optional<Hit>& expected) {
            return is_same(hits[i], expected);
        }
    );
    if (outcome.mismatches == 0 && !session.options.output.empty())
        session.put_files([&] { save_hits(session.options.output, hits); });
    return outcome;
}

Outcome trace_any(
    const TraceOptions& options,
    const Tracer& tracer,
    const Scene& scene,
    std::span<const Ray> rays,
    const Session& session
) {
    Outcome outcome{
        .rays = rays.size(), .verified = std::min<std::uint64_t>(options.verify, rays.size())
    };
    const Stopwatch stopwatch;
    const auto occluded = any_hits(tracer, rays, session.executor(), session.progress());
    outcome.trace_ms = stopwatch.milliseconds();
    for (const std::uint8_t flag : occluded)
        outcome.hits += flag;
    outcome.mismatches = count_mismatches(
        scene,
        rays,
        outcome.verified,
        session.progress(),
        [&](std::size_t i, const std::optional<Hit>& expected) {
            return (occluded[i] != 0) == expected.has_value();
        }
    );
    if (outcome.mismatches == 0 && !session.options.output.empty())
        session.put_files([&] { save_occlusion(session.options.output, occluded); });
    return outcome;
}

Report describe(const Outcome& outcome, bool any) {
    const auto rays = static_cast<double>(outcome.rays);
    Report report;
    report.title = any ? "Any hit" : "Closest hit";
    ReportTable& table = report.table;
    add_count(table, "rays", outcome.rays);
    add_count(table, "hits", outcome.hits);
    add_fact(table, "hit_fraction", static_cast<double>(outcome.hits) / rays);
    add_fact(table, "trace_ms", outcome.trace_ms);
    add_fact(table, "rays_per_s", rays / outcome.trace_ms * 1e3);
    add_count(table, "verified_rays", outcome.verified);
    add_count(table, "mismatches", outcome.mismatches);
    if (outcome.verified > 0)
        report.findings = {fmt::format(
            "{} rays verified by brute force over all triangles: {} mismatches.",
            outcome.verified,
            outcome.mismatches
        )};
    return report;
}

void trace(const TraceOptions& options, const Session& session) {
    if (options.rays_file.empty() == (options.sample == 0))
        throw UsageError(
            options.sample == 0 ? "rays are needed: --rays FILE or --sample N"
                                : "rays come from --rays or --sample, not both"
        );
    if (options.fast && !options.tree_file.empty())
        throw UsageError("--fast is for what raywise builds itself: it goes without --tree");
    if (options.fast && options.verify > 0)
        throw UsageError("--verify asks for exact answers: it goes without --fast");
    const Scene scene = open_scene(options.source, session);
    const std::vector<InfluenceArea> areas = open_areas(options.areas_file, scene, session);
    const std::vector<Ray> rays =
        options.sample > 0 ? draw_rays(options, areas, session) : load_rays(options.rays_file);
    require_memory(
        options.source,
        scene.triangles.size() * bytes_per_triangle * (areas.size() + 1) +
            rays.size() * bytes_per_ray,
        "tracing"
    );
    if (!options.save_rays_file.empty())
        session.put_files([&] { save_rays(options.save_rays_file, rays); });

    AcceleratorParams params;
    if (options.fast) params.trace_mode = TraceMode::fast;
    const Tracer tracer =
        options.tree_file.empty()
            ? Tracer(build_accelerator(scene, areas, params, session.executor(), session.progress())
              )
            : Tracer(open_tree(options.tree_file, scene));
    const Outcome outcome = options.any ? trace_any(options, tracer, scene, rays, session)
                                        : trace_closest(options, tracer, scene, rays, session);
    Report report = describe(outcome, options.any);
    report.provenance = session.provenance();
    report.provenance.scene = scene_title(options.source);
    report.provenance.scene_hash = content_hash(scene);
    session.put_report(report, {});
    if (outcome.mismatches > 0)
        throw CheckFailed(fmt::format(
            "{} of {} verified rays have a wrong answer", outcome.mismatches, outcome.verified
        ));
}

} // namespace

Command add_trace(CLI::App& root, CommonOptions& options) {
    CLI::App* app =
        root.add_subcommand("trace", "Find what rays hit: rays of a file, or drawn from the areas");
    const auto own = std::make_shared<TraceOptions>();
    add_scene_options(*app, own->source);
    add_area_options(*app, own->areas_file);
    app->add_option("--rays", own->rays_file, "Rays to trace: .npy or .npz, N x 8 or N x 6");
    app->add_option("--sample", own->sample, "Draw this many rays from every area instead")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000}));
    app->add_option("--save-rays", own->save_rays_file, "Write the rays as .npy");
    app->add_option(
        "--tree",
        own->tree_file,
        "Trace through the tree of this file (.rwtree) instead of building"
    );
    app->add_option("--verify", own->verify, "Check this many of the answers by brute force")
        ->capture_default_str();
    app->add_flag("--any", own->any, "Ask only whether there is a hit; -o is then a .npy of bool");
    app->add_flag(
        "--fast",
        own->fast,
        "Decide hits by floats alone: rays that graze edges may be answered wrongly"
    );
    add_common_options(*app, options, "Write the hits to this file (.npz)");
    return {app, {}, [own](const Session& session) { trace(*own, session); }};
}

} // namespace raywise::app
