#include <raywise/io/report.hpp>

#include "bench/goals.hpp"
#include "bench/report.hpp"
#include "bench/rows.hpp"

#include <raywise/analysis/ray_class.hpp>
#include <raywise/analysis/statistics.hpp>
#include <raywise/core/hash.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raywise::app {

namespace {

/// How a column is computed: a column's name and meaning stand side by side.
template <class Row>
struct ColumnOf {
    ColumnName name;
    std::function<Cell(const Row&)> cell;
};

template <class Row>
ReportTable table_of(std::span<const Row> rows, const std::vector<ColumnOf<Row>>& columns) {
    ReportTable table;
    for (const ColumnOf<Row>& column : columns)
        table.columns.push_back(column.name);
    for (const Row& row : rows) {
        std::vector<Cell>& cells = table.rows.emplace_back();
        for (const ColumnOf<Row>& column : columns)
            cells.push_back(column.cell(row));
    }
    return table;
}

Cell count(std::uint64_t value) {
    return static_cast<std::int64_t>(value);
}

Cell text(std::string_view value) {
    return std::string(value);
}

Cell maybe(const std::optional<double>& value) {
    return value ? Cell(*value) : Cell();
}

/// Times are absent, not zero, when nothing was timed.
Cell timed(const BenchRow& row, double value) {
    return row.rounds > 0 ? Cell(value) : Cell();
}

using RowColumns = std::vector<ColumnOf<BenchRow>>;

RowColumns deciding_columns() {
    return {
        {"scene", [](const BenchRow& row) { return text(row.scene); }},
        {"rays", [](const BenchRow& row) { return text(name_of(row.rays)); }},
        {"kind", [](const BenchRow& row) { return text(name_of(kind_of(row.rays))); }},
        {"query",
         [](const BenchRow& row) { return text(asks_closest(row.rays) ? "closest" : "occluded"); }},
        {"peer", [](const BenchRow& row) { return text(name_of(row.peer)); }},
        {"ours_mrays", [](const BenchRow& row) { return timed(row, row.ours_mrays); }},
        {"peer_mrays", [](const BenchRow& row) { return timed(row, row.peer_mrays); }},
        {"ratio", [](const BenchRow& row) { return timed(row, row.ratio); }},
        {"spread", [](const BenchRow& row) { return timed(row, row.spread); }},
        {"ratio_robust", [](const BenchRow& row) { return maybe(row.ratio_robust); }},
        {"structure", [](const BenchRow& row) { return text(row.structure); }},
        {"mismatches", [](const BenchRow& row) { return count(row.mismatches); }},
        {"node_visits", [](const BenchRow& row) { return Cell(row.node_visits); }},
        {"triangle_tests", [](const BenchRow& row) { return Cell(row.triangle_tests); }},
    };
}

RowColumns all_columns() {
    RowColumns columns = deciding_columns();
    const RowColumns more = {
        {"verified", [](const BenchRow& row) { return Cell(row.mismatches == 0); }},
        {"mode", [](const BenchRow&) { return text("watertight"); }},
        {"peer_call", [](const BenchRow& row) { return text(row.peer_call); }},
        {"peer_wrong", [](const BenchRow& row) { return count(row.peer_wrong); }},
        {"ratio_fast", [](const BenchRow& row) { return maybe(row.ratio_fast); }},
        {"ratio_fast_robust", [](const BenchRow& row) { return maybe(row.ratio_fast_robust); }},
        {"fast_wrong",
         [](const BenchRow& row) { return row.fast_wrong ? count(*row.fast_wrong) : Cell(); }},
        {"ratio_sorted", [](const BenchRow& row) { return maybe(row.ratio_sorted); }},
        {"searched_mrays", [](const BenchRow& row) { return maybe(row.searched_mrays); }},
        {"ray_count", [](const BenchRow& row) { return count(row.count); }},
        {"hit_share", [](const BenchRow& row) { return Cell(row.hit_share); }},
        {"rounds", [](const BenchRow& row) { return count(static_cast<unsigned>(row.rounds)); }},
        {"brute_forced", [](const BenchRow& row) { return count(row.brute_forced); }},
        {"triangles", [](const BenchRow& row) { return count(row.triangles); }},
        {"scene_hash", [](const BenchRow& row) { return text(hex(row.scene_hash)); }},
        {"ray_hash", [](const BenchRow& row) { return text(hex(row.ray_hash)); }},
    };
    columns.insert(columns.end(), more.begin(), more.end());
    return columns;
}

std::vector<ColumnOf<BuildRow>> build_columns() {
    return {
        {"scene", [](const BuildRow& row) { return text(row.scene); }},
        {"triangles", [](const BuildRow& row) { return count(row.triangles); }},
        {"structure", [](const BuildRow& row) { return text(row.structure); }},
        {"threads", [](const BuildRow& row) { return count(static_cast<unsigned>(row.threads)); }},
        {"build_ms", [](const BuildRow& row) { return Cell(row.build_ms); }},
        {"bytes", [](const BuildRow& row) { return count(row.bytes); }},
    };
}

std::vector<ColumnOf<BreakEvenRow>> break_even_columns() {
    return {
        {"scene", [](const BreakEvenRow& row) { return text(row.scene); }},
        {"rays", [](const BreakEvenRow& row) { return text(name_of(row.rays)); }},
        {"peer", [](const BreakEvenRow& row) { return text(name_of(row.peer)); }},
        {"build_ms", [](const BreakEvenRow& row) { return Cell(row.build_ms); }},
        {"ours_ns", [](const BreakEvenRow& row) { return Cell(row.ours_ns); }},
        {"peer_ns", [](const BreakEvenRow& row) { return Cell(row.peer_ns); }},
        {"rays_per_triangle", [](const BreakEvenRow& row) { return maybe(row.rays_per_triangle); }},
    };
}

std::vector<ColumnOf<LimitRow>> limit_columns() {
    return {
        {"scene", [](const LimitRow& row) { return text(row.scene); }},
        {"bytes", [](const LimitRow& row) { return count(row.bytes); }},
        {"load_ns", [](const LimitRow& row) { return Cell(row.load_ns); }},
        {"stream_gb_per_s", [](const LimitRow& row) { return Cell(row.stream_gb_per_s); }},
        {"ours_ns", [](const LimitRow& row) { return Cell(row.ours_ns); }},
        {"share", [](const LimitRow& row) { return Cell(row.share); }},
    };
}

std::vector<ColumnOf<GrowthRow>> growth_columns() {
    return {
        {"scene", [](const GrowthRow& row) { return text(row.scene); }},
        {"rays", [](const GrowthRow& row) { return text(name_of(row.rays)); }},
        {"peer", [](const GrowthRow& row) { return text(name_of(row.peer)); }},
        {"from_triangles", [](const GrowthRow& row) { return count(row.from_triangles); }},
        {"to_triangles", [](const GrowthRow& row) { return count(row.to_triangles); }},
        {"ours_growth", [](const GrowthRow& row) { return Cell(row.ours); }},
        {"peer_growth", [](const GrowthRow& row) { return Cell(row.peer_growth); }},
        {"growth_ratio", [](const GrowthRow& row) { return Cell(row.ours / row.peer_growth); }},
    };
}

std::vector<ColumnOf<ThreadRow>> thread_columns() {
    return {
        {"scene", [](const ThreadRow& row) { return text(row.scene); }},
        {"work", [](const ThreadRow& row) { return text(row.work); }},
        {"threads", [](const ThreadRow& row) { return count(static_cast<unsigned>(row.threads)); }},
        {"one_thread_ms", [](const ThreadRow& row) { return Cell(row.one_ms); }},
        {"all_threads_ms", [](const ThreadRow& row) { return Cell(row.all_ms); }},
        {"speedup", [](const ThreadRow& row) { return Cell(row.speedup); }},
        {"spread", [](const ThreadRow& row) { return Cell(row.spread); }},
    };
}

template <class Row>
void add_table(
    Report& report,
    const char* key,
    const char* title,
    std::span<const Row> rows,
    const std::vector<ColumnOf<Row>>& columns
) {
    if (!rows.empty()) report.more.push_back({key, title, table_of<Row>(rows, columns)});
}

/// Over the scenes; a scene's own is the geometric mean of its rows, so that one with more classes
/// counts no more than another.
struct Means {
    double all = 1;
    double worst = 1;
    std::string worst_scene;
    std::size_t scenes = 0;
};

/// Of the timed rows that `is_meant` picks.
template <class IsMeant>
Means means_of(const SceneBench& bench, const IsMeant& is_meant) {
    std::map<std::string, std::vector<double>> by_scene;
    for (const BenchRow& row : bench.rows)
        if (row.rounds > 0 && is_meant(row)) by_scene[row.scene].push_back(row.ratio);
    Means means;
    std::vector<double> of_scenes;
    for (const auto& [scene, ratios] : by_scene) {
        const double of_scene = geometric_mean(ratios);
        if (of_scenes.empty() || of_scene < means.worst) {
            means.worst = of_scene;
            means.worst_scene = scene;
        }
        of_scenes.push_back(of_scene);
    }
    means.scenes = of_scenes.size();
    means.all = geometric_mean(of_scenes);
    return means;
}

/// What a class of rays gives over all scenes.
struct ClassMeans {
    RayClass rays = RayClass::primary;
    Peer peer = Peer::single;
    Means means;
};

std::vector<ClassMeans> class_means(const SceneBench& bench) {
    std::vector<ClassMeans> rows;
    for (const RayClass rays : all_ray_classes()) {
        for (const Peer peer : {Peer::single, Peer::best}) {
            const Means means = means_of(bench, [&](const BenchRow& row) {
                return row.rays == rays && row.peer == peer;
            });
            if (means.scenes > 1) rows.push_back({rays, peer, means});
        }
    }
    return rows;
}

std::vector<ColumnOf<ClassMeans>> class_columns() {
    return {
        {"rays", [](const ClassMeans& row) { return text(name_of(row.rays)); }},
        {"peer", [](const ClassMeans& row) { return text(name_of(row.peer)); }},
        {"scenes", [](const ClassMeans& row) { return count(row.means.scenes); }},
        {"ratio", [](const ClassMeans& row) { return Cell(row.means.all); }},
        {"worst_ratio", [](const ClassMeans& row) { return Cell(row.means.worst); }},
        {"worst_scene", [](const ClassMeans& row) { return text(row.means.worst_scene); }},
    };
}

std::string verdict(const Means& means, RayKind kind, Peer peer) {
    std::string line = fmt::format(
        "{} beside {}: {:.2f}x over {} scene{}, worst {:.2f}x ({})",
        name_of(kind),
        name_of(peer),
        means.all,
        means.scenes,
        means.scenes == 1 ? "" : "s",
        means.worst,
        means.worst_scene
    );
    const std::optional<Goal> goal = goal_of(kind, peer);
    if (!goal) return line + "; no goal is set.";
    const bool is_met = means.all >= goal->mean && means.worst >= goal->worst;
    return line + fmt::format(
                      "; goal {:.1f}x, worst {:.1f}x: {}.",
                      goal->mean,
                      goal->worst,
                      is_met ? "met" : "not met"
                  );
}

std::vector<std::string> findings_of(const SceneBench& bench) {
    std::vector<std::string> findings;
    for (const RayKind kind : {RayKind::exact, RayKind::near_affine, RayKind::general}) {
        for (const Peer peer : {Peer::single, Peer::best}) {
            const Means means = means_of(bench, [&](const BenchRow& row) {
                return kind_of(row.rays) == kind && row.peer == peer;
            });
            if (means.scenes > 0) findings.push_back(verdict(means, kind, peer));
        }
    }
    std::size_t answers = 0;
    std::size_t wrong = 0;
    std::size_t peer_wrong = 0;
    std::size_t brute_forced = 0;
    for (const BenchRow& row : bench.rows) {
        answers += row.count;
        wrong += row.mismatches;
        peer_wrong += row.peer_wrong;
        if (row.peer == Peer::single) brute_forced += row.brute_forced;
    }
    findings.push_back(fmt::format(
        "Verified before timing: {} answers, {} of ours and {} of Embree's differ from the exact "
        "oracle, which {} rays by brute force confirm.",
        answers,
        wrong,
        peer_wrong,
        brute_forced
    ));
    return findings;
}

} // namespace

Report report_of(const SceneBench& bench, ReportFormat format, Provenance provenance) {
    Report report;
    report.title =
        "Mrays/s beside Embree: same rays, verified answers, ratios of interleaved pairs";
    report.table = table_of<BenchRow>(
        bench.rows, format == ReportFormat::table ? deciding_columns() : all_columns()
    );
    add_table<ClassMeans>(
        report,
        "classes",
        "Ratios over the scenes, geometric means",
        class_means(bench),
        class_columns()
    );
    add_table<BuildRow>(report, "builds", "Builds", bench.builds, build_columns());
    add_table<BreakEvenRow>(
        report,
        "break_even",
        "Exact rays per triangle after which building a pencil grid has paid (goal: 2)",
        bench.break_even,
        break_even_columns()
    );
    add_table<LimitRow>(
        report,
        "limits",
        "Memory at the size of a pencil grid; share: two dependent loads over the time of a ray",
        bench.limits,
        limit_columns()
    );
    add_table<GrowthRow>(
        report,
        "growth",
        "Growth of the time per ray from the smallest to the largest scene (goal: ratio 1)",
        bench.growth,
        growth_columns()
    );
    add_table<ThreadRow>(
        report,
        "threads",
        "All threads over one (goal for two: 1.9 building, 1.95 tracing)",
        bench.threads,
        thread_columns()
    );
    report.findings = findings_of(bench);
    report.provenance = std::move(provenance);
    return report;
}

} // namespace raywise::app
