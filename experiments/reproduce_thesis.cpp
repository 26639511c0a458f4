// Prints our faithful-mode costs beside those of [Falcone24], as the table of docs/reproduction.md.
//
//     reproduce_thesis thesis_results.csv [cottage.ply] > table.md
//
// The set-ups are read from the published runs themselves; scenes that are not at hand are left
// out.
#include <raywise/analysis/comparison.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/io/load_scene.hpp>
#include <raywise/scene/generate.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

namespace {

using namespace raywise;

/// One line of the published runs, by column name.
using Run = std::map<std::string, std::string>;

std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');)
        cells.push_back(cell);
    return cells;
}

std::vector<Run> read_runs(const std::string& path) {
    std::ifstream in(path);
    std::string line;
    if (!std::getline(in, line)) throw Error(ErrorKind::io, path, nowhere(), "cannot be read");
    const std::vector<std::string> columns = split(line);
    std::vector<Run> runs;
    while (std::getline(in, line)) {
        const std::vector<std::string> cells = split(line);
        Run run;
        for (std::size_t i = 0; i < columns.size() && i < cells.size(); ++i) {
            run[columns[i]] = cells[i];
        }
        runs.push_back(run);
    }
    return runs;
}

double number(const Run& run, const std::string& column) {
    const auto found = run.find(column);
    if (found == run.end() || found->second.empty()) return std::nan("");
    return std::stod(found->second);
}

Vec3d vector_of(const Run& run, const std::string& prefix) {
    return {number(run, prefix + "x"), number(run, prefix + "y"), number(run, prefix + "z")};
}

InfluenceArea area_of(const Run& run) {
    const std::string name =
        run.at("scene") + "_" + run.at("influence_kind") + "_" + run.at("ray_setup");
    if (run.at("influence_kind") == "plane") {
        PlaneArea area;
        area.point = vector_of(run, "ia_p");
        area.normal = vector_of(run, "ia_d");
        area.half_width = number(run, "ia_half_width");
        area.half_height = number(run, "ia_half_height");
        area.depth = number(run, "ia_depth");
        return InfluenceArea::plane(name, area);
    }
    PointArea area;
    area.eye = vector_of(run, "ia_p");
    area.direction = vector_of(run, "ia_d");
    area.fov_x_deg = number(run, "ia_fov_x_deg");
    area.fov_y_deg = number(run, "ia_fov_y_deg");
    area.near = number(run, "ia_near");
    area.far = number(run, "ia_far");
    return InfluenceArea::point(name, area);
}

Variant variant_of(const std::string& pair) {
    const bool is_pah = pair.rfind("PAH", 0) == 0;
    const bool is_facing = pair.find("SPFH") != std::string::npos;
    return {
        is_pah ? Variant::Measure::area : Variant::Measure::surface,
        is_facing ? Variant::Axes::facing : Variant::Axes::longest
    };
}

/// Ours against theirs over all runs.
struct Agreement {
    std::vector<double> differences; // ours / theirs - 1

    void add(double ours, double theirs) {
        if (theirs > 0) differences.push_back(ours / theirs - 1);
    }

    void print(const char* what) const {
        double squares = 0;
        double largest = 0;
        std::size_t near = 0;
        for (const double d : differences) {
            squares += d * d;
            largest = std::max(largest, std::abs(d));
            near += std::abs(d) <= 0.1 ? 1U : 0U;
        }
        const auto count = static_cast<double>(differences.size());
        fmt::print(
            "| {} | {} | {:+.2f} % | {:.2f} % | {:.1f} % | {} |\n",
            what,
            differences.size(),
            100 * mean(differences),
            100 * std::sqrt(squares / count),
            100 * largest,
            near
        );
    }
};

/// The agreement of every quantity, split where the sources of error differ.
struct Agreements {
    std::map<std::string, Agreement> of;

    void print() const {
        fmt::print("\n| quantity | runs | mean | rms | largest | within 10 % "
                   "|\n|---|---|---|---|---|---|\n");
        for (const auto& [what, agreement] : of)
            agreement.print(what.c_str());
    }
};

std::optional<Scene> scene_named(const std::string& name, const std::string& cottage) {
    if (name == "Random100") return generate_random_triangles(100, 1);
    if (name == "Random1000") return generate_random_triangles(1000, 1, 100);
    if (name == "Cottage" && !cottage.empty()) return load_scene(cottage);
    return std::nullopt;
}

void print_run(
    const Run& run,
    const ComparisonRow& row,
    const ComparisonRow& base,
    const Run& base_run,
    Agreements& all
) {
    const std::string kind = run.at("influence_kind");
    const double inner = static_cast<double>(std::max<std::size_t>(row.build_work.inner_nodes, 1));
    const double evaluations = static_cast<double>(row.build_work.cost_evaluations) / inner;
    const double ratio = row.real_cost.mean / base.real_cost.mean;
    const double published_ratio = number(run, "real_cost") / number(base_run, "real_cost");
    fmt::print(
        "| {} {} {} | {} | {:.2f} / {:.2f} | {:.2f} / {:.2f} | {:.1f} ± {:.1f} / {:.1f} | {:+.1f} "
        "% | {:.3f} / {:.3f} | "
        "{:.2f} / {:.2f} | {} / {} |\n",
        run.at("scene"),
        kind,
        run.at("ray_setup"),
        run.at("heuristics_actual"),
        row.estimated_cost_sah,
        number(run, "estimated_sah"),
        row.estimated_cost,
        number(run, "estimated_pah"),
        row.real_cost.mean,
        row.real_cost.half_width,
        number(run, "real_cost"),
        100 * (row.real_cost.mean / number(run, "real_cost") - 1),
        ratio,
        published_ratio,
        evaluations,
        number(run, "cost_evals_per_internal_node"),
        row.depth,
        run.at("levels")
    );
    all.of[kind + ": estimated SAH"].add(row.estimated_cost_sah, number(run, "estimated_sah"));
    all.of[kind + ": estimated PAH"].add(row.estimated_cost, number(run, "estimated_pah"));
    all.of[kind + ": real cost"].add(row.real_cost.mean, number(run, "real_cost"));
    all.of[kind + ": real cost over SAH+LSPH"].add(ratio, published_ratio);
    all.of[kind + ": cost evaluations per node"].add(
        evaluations, number(run, "cost_evals_per_internal_node")
    );
    all.of[kind + ": overlap"].add(row.overlap, number(run, "overlap_all"));
}

/// Runs of one scene and set-up, which share an area, and ours for each of them.
void reproduce(const Scene& scene, const std::vector<Run>& runs, Agreements& all) {
    CompareParams params = faithful_params();
    params.seeds = 20; // as many ray sets as tell the noise of one
    const std::vector<InfluenceArea> areas{area_of(runs.front())};
    const Comparison comparison = compare(scene, areas, params, Executor());
    const auto row_of = [&](const std::string& pair) -> const ComparisonRow& {
        return *std::find_if(comparison.rows.begin(), comparison.rows.end(), [&](const auto& row) {
            return row.variant == variant_of(pair);
        });
    };
    const auto base_run = std::find_if(runs.begin(), runs.end(), [](const Run& run) {
        return run.at("heuristics_actual") == "SAH+LSPH";
    });
    if (base_run == runs.end()) return;
    all.of[runs.front().at("influence_kind") + ": global real cost"].add(
        comparison.areas.front().global_real_cost.mean, number(*base_run, "global_sah_cost")
    );
    for (const Run& run : runs) {
        const std::string& pair = run.at("heuristics_actual");
        if (!run.at("flags").empty() && run.at("flags") != "NO_FALLBACK_SEARCH") continue;
        print_run(run, row_of(pair), row_of("SAH+LSPH"), *base_run, all);
    }
}

void reproduce_all(const std::string& runs_path, const std::string& cottage) {
    std::map<std::tuple<std::string, std::string, std::string>, std::vector<Run>> groups;
    for (const Run& run : read_runs(runs_path)) {
        groups[{run.at("scene"), run.at("influence_kind"), run.at("ray_setup")}].push_back(run);
    }
    fmt::print("Each cell: ours / published.\n\n"
               "| scene, set-up | pair | estimated SAH | estimated PAH | real cost (20 ray sets) | "
               "difference | over SAH+LSPH | evaluations per node | depth |\n"
               "|---|---|---|---|---|---|---|---|---|\n");
    Agreements all;
    for (const auto& [key, runs] : groups) {
        const std::optional<Scene> scene = scene_named(std::get<0>(key), cottage);
        if (scene) reproduce(*scene, runs, all);
    }
    all.print();
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argc > 3) {
        fmt::print(stderr, "usage: reproduce_thesis thesis_results.csv [cottage.ply]\n");
        return 2;
    }
    try {
        reproduce_all(argv[1], argc == 3 ? argv[2] : "");
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "reproduce_thesis: {}\n", error.what());
        return 3;
    }
}
