#include "comparison_report.hpp"

#include <raywise/analysis/comparison.hpp>
#include <raywise/analysis/statistics.hpp>
#include <raywise/io/report.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace raywise::app {

namespace {

/// How a column is computed. Reports are lists of these, so a column's name and meaning stand side
/// by side.
struct ColumnOf {
    ColumnName name;
    std::function<Cell(const AreaSummary&, const ComparisonRow&)> cell;
};

Cell count(std::uint64_t value) {
    return static_cast<std::int64_t>(value);
}

Cell maybe(const std::optional<double>& value) {
    return value ? Cell(*value) : Cell();
}

ColumnOf of_area(ColumnName name, double AreaSummary::* member) {
    return {std::move(name), [member](const AreaSummary& area, const ComparisonRow&) {
                return Cell(area.*member);
            }};
}

ColumnOf of_row(ColumnName name, double ComparisonRow::* member) {
    return {std::move(name), [member](const AreaSummary&, const ComparisonRow& row) {
                return Cell(row.*member);
            }};
}

ColumnOf of_row(ColumnName name, std::size_t ComparisonRow::* member) {
    return {std::move(name), [member](const AreaSummary&, const ComparisonRow& row) {
                return count(row.*member);
            }};
}

ColumnOf mean_of(ColumnName name, ConfidenceInterval ComparisonRow::* member) {
    return {std::move(name), [member](const AreaSummary&, const ComparisonRow& row) {
                return Cell((row.*member).mean);
            }};
}

/// Mean and, beside it, half the width of the 95 % interval.
void add_interval(
    std::vector<ColumnOf>& columns,
    const ColumnName& name,
    ConfidenceInterval ComparisonRow::* member
) {
    columns.push_back(mean_of(name, member));
    columns.push_back({name + "_ci95", [member](const AreaSummary&, const ComparisonRow& row) {
                           return Cell((row.*member).half_width);
                       }});
}

/// Times are absent, not zero, when nothing was timed.
ColumnOf timed(ColumnOf column, bool is_timed) {
    if (!is_timed) column.cell = [](const AreaSummary&, const ComparisonRow&) { return Cell(); };
    return column;
}

const ColumnOf area_name = {"area", [](const AreaSummary& area, const ComparisonRow&) {
                                return Cell(area.name);
                            }};
const ColumnOf pair_name = {"pair", [](const AreaSummary&, const ComparisonRow& row) {
                                return Cell(name_of(row.variant));
                            }};

/// Says "yes" beside the best pair of each area.
ColumnOf winner_mark(const Comparison& comparison) {
    return {"is_winner", [&comparison](const AreaSummary& area, const ComparisonRow& row) {
                return &row == &comparison.rows[area.winner] ? Cell(true) : Cell();
            }};
}

std::vector<ColumnOf> deciding_columns(bool is_timed) {
    std::vector<ColumnOf> columns = {
        area_name,
        pair_name,
        of_row("triangles", &ComparisonRow::triangles),
        of_row("nodes", &ComparisonRow::nodes),
        mean_of("real_cost", &ComparisonRow::real_cost),
        mean_of("ordered_cost", &ComparisonRow::ordered_cost),
        mean_of("any_hit_cost", &ComparisonRow::any_hit_cost),
        mean_of("ordered_ratio", &ComparisonRow::ordered_ratio),
        mean_of("full_ratio", &ComparisonRow::full_ratio),
    };
    if (is_timed) {
        columns.push_back(of_row("build_ms", &ComparisonRow::build_ms));
        columns.push_back(mean_of("ns_per_ray", &ComparisonRow::ns_per_ray));
        columns.push_back(mean_of("full_ns_ratio", &ComparisonRow::full_ns_ratio));
    }
    return columns;
}

void add_tree_columns(std::vector<ColumnOf>& columns, bool is_timed) {
    columns.push_back({"is_baseline", [](const AreaSummary&, const ComparisonRow& row) {
                           return Cell(row.is_baseline);
                       }});
    columns.push_back(of_row("triangles", &ComparisonRow::triangles));
    columns.push_back(of_row("nodes", &ComparisonRow::nodes));
    columns.push_back(of_row("leaves", &ComparisonRow::leaves));
    columns.push_back({"depth", [](const AreaSummary&, const ComparisonRow& row) {
                           return Cell(std::int64_t{row.depth});
                       }});
    columns.push_back({"memory_bytes", [](const AreaSummary&, const ComparisonRow& row) {
                           return count(row.memory.total());
                       }});
    columns.push_back(timed(of_row("build_ms", &ComparisonRow::build_ms), is_timed));
    columns.push_back(of_row("overlap", &ComparisonRow::overlap));
    columns.push_back(of_row("overlap_unculled", &ComparisonRow::overlap_unculled));
    columns.push_back(of_row("end_point_overlap", &ComparisonRow::end_point_overlap));
}

void add_local_columns(std::vector<ColumnOf>& columns, bool is_timed) {
    columns.push_back(of_row("estimated_cost", &ComparisonRow::estimated_cost));
    columns.push_back(of_row("estimated_cost_sah", &ComparisonRow::estimated_cost_sah));
    add_interval(columns, "real_cost", &ComparisonRow::real_cost);
    columns.push_back(of_row("estimate_error", &ComparisonRow::estimate_error));
    columns.push_back(of_row("estimate_error_sah", &ComparisonRow::estimate_error_sah));
    add_interval(columns, "hits_per_ray", &ComparisonRow::hits_per_ray);
    add_interval(columns, "box_tests", &ComparisonRow::box_tests);
    add_interval(columns, "node_visits", &ComparisonRow::node_visits);
    add_interval(columns, "triangle_tests", &ComparisonRow::prim_tests);
    add_interval(columns, "ordered_cost", &ComparisonRow::ordered_cost);
    columns.push_back(of_row("ordered_cost_median", &ComparisonRow::ordered_cost_median));
    columns.push_back(of_row("ordered_cost_p95", &ComparisonRow::ordered_cost_percentile_95));
    add_interval(columns, "any_hit_cost", &ComparisonRow::any_hit_cost);
    add_interval(columns, "ordered_ratio", &ComparisonRow::ordered_ratio);
    columns.push_back(timed(mean_of("ns_per_ray", &ComparisonRow::ns_per_ray), is_timed));
    columns.push_back(timed(mean_of("ns_ratio", &ComparisonRow::ns_ratio), is_timed));
}

void add_full_columns(std::vector<ColumnOf>& columns, bool is_timed) {
    add_interval(columns, "full_cost", &ComparisonRow::full_cost);
    add_interval(columns, "full_ratio", &ComparisonRow::full_ratio);
    columns.push_back(timed(mean_of("full_ns_per_ray", &ComparisonRow::full_ns), is_timed));
    columns.push_back(timed(mean_of("full_ns_ratio", &ComparisonRow::full_ns_ratio), is_timed));
    columns.push_back(of_row("restart_cost", &ComparisonRow::restart_cost));
    columns.push_back({"break_even_hit_fraction", [](const AreaSummary&, const ComparisonRow& row) {
                           return maybe(row.break_even_hit_fraction);
                       }});
    columns.push_back({"break_even_rays", [](const AreaSummary&, const ComparisonRow& row) {
                           return maybe(row.break_even_rays);
                       }});
}

void add_area_columns(std::vector<ColumnOf>& columns) {
    columns.push_back(of_area("root_probability", &AreaSummary::root_probability));
    columns.push_back(of_area("hit_fraction", &AreaSummary::hit_fraction));
    columns.push_back(of_area("answered_fraction", &AreaSummary::answered_fraction));
    columns.push_back(of_area("local_hit_fraction", &AreaSummary::local_hit_fraction));
    columns.push_back(of_area("continuation_fraction", &AreaSummary::continuation_fraction));
    columns.push_back(of_area("continuation_hit_fraction", &AreaSummary::continuation_hit_fraction)
    );
    columns.push_back(of_area("continuation_cost", &AreaSummary::continuation_cost));
    columns.push_back({"global_cost", [](const AreaSummary& area, const ComparisonRow&) {
                           return Cell(area.global_cost.mean);
                       }});
    columns.push_back({"global_real_cost", [](const AreaSummary& area, const ComparisonRow&) {
                           return Cell(area.global_real_cost.mean);
                       }});
    columns.push_back({"verified_rays", [](const AreaSummary& area, const ComparisonRow&) {
                           return count(area.checked_by_brute_force);
                       }});
    columns.push_back({"mismatches", [](const AreaSummary&, const ComparisonRow& row) {
                           return count(row.mismatches);
                       }});
}

std::vector<ColumnOf> all_columns(bool is_timed) {
    std::vector<ColumnOf> columns = {area_name, pair_name};
    add_tree_columns(columns, is_timed);
    add_local_columns(columns, is_timed);
    add_full_columns(columns, is_timed);
    add_area_columns(columns);
    return columns;
}

std::string verified_text(const Comparison& comparison) {
    std::uint64_t checked = 0;
    for (const AreaSummary& area : comparison.areas)
        checked += area.checked_by_brute_force;
    return fmt::format(
        "Answers verified: every pair gave the same hits as the global tree, {} rays also as brute "
        "force; "
        "{} mismatches.",
        checked,
        comparison.mismatches
    );
}

std::vector<std::string> findings_of(const Comparison& comparison) {
    std::vector<std::string> findings;
    findings.reserve(comparison.areas.size());
    for (std::size_t i = 0; i < comparison.areas.size(); ++i)
        findings.push_back(comparison.areas[i].name + ": " + verdict_text(comparison, i) + ".");
    if (comparison.areas.size() > 1)
        for (const VariantSummary& variant : comparison.variants)
            findings.push_back(fmt::format(
                "{}: ordered cost {:.3f} of {}, full cost {:.3f} of the global tree alone "
                "(geometric means over {} "
                "areas), {} won.",
                name_of(variant.variant),
                variant.ordered_ratio,
                name_of(strong_baseline),
                variant.full_ratio,
                comparison.areas.size(),
                variant.wins
            ));
    findings.push_back(verified_text(comparison));
    return findings;
}

} // namespace

Report report_of(const Comparison& comparison, ReportFormat format, Provenance provenance) {
    const bool is_timed = comparison.params.repeats > 0;
    std::vector<ColumnOf> columns =
        format == ReportFormat::table ? deciding_columns(is_timed) : all_columns(is_timed);
    columns.push_back(winner_mark(comparison));
    Report report;
    report.title = fmt::format(
        "{}: {} triangles, {} areas, {} x {} rays each",
        comparison.scene,
        comparison.triangles,
        comparison.areas.size(),
        comparison.params.seeds,
        comparison.params.rays
    );
    for (const ColumnOf& column : columns)
        report.table.columns.push_back(column.name);
    for (const ComparisonRow& row : comparison.rows) {
        std::vector<Cell>& cells = report.table.rows.emplace_back();
        for (const ColumnOf& column : columns)
            cells.push_back(column.cell(comparison.areas[row.area], row));
    }
    report.findings = findings_of(comparison);
    report.provenance = std::move(provenance);
    report.provenance.scene = comparison.scene;
    report.provenance.scene_hash = comparison.scene_hash;
    report.provenance.constants = comparison.params.constants;
    report.provenance.normalization =
        "costs per emitted ray, in box tests; estimated_cost_sah per ray that hits the root";
    return report;
}

} // namespace raywise::app
