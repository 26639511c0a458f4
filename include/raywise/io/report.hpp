// Results as rows of named cells, for people (aligned text) and for programs (CSV, JSON), with what
// they were computed from.
#pragma once

#include <raywise/bvh/cost_constants.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace raywise {

/// Nothing, a truth, a count, a number or a text. NaN and infinite numbers are written as absent.
using Cell = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

/// A column: its name in snake_case with a unit suffix (`build_ms`), as CSV and JSON show it.
using ColumnName = std::string;

/// Every row has one cell per column.
struct ReportTable {
    std::vector<ColumnName> columns;
    std::vector<std::vector<Cell>> rows;
};

/// Adds a column and its cell to a table of at most one row, which stands upright as text: name
/// beside value.
void add_fact(ReportTable& table, ColumnName name, Cell value);

/// The same for a count below 2^63.
void add_count(ReportTable& table, ColumnName name, std::uint64_t value);

/// What the numbers were computed from and with: stands beside every published number.
struct Provenance {
    std::string version;  ///< of raywise, with the commit if known
    std::string compiler; ///< name and version
    std::string cpu;      ///< model name
    int threads = 1;
    std::uint64_t seed = 0;
    std::string scene;            ///< file name or recipe
    std::uint64_t scene_hash = 0; ///< content_hash of the scene
    CostConstants constants;
    std::string normalization; ///< how costs are scaled, in words; empty when no cost is shown
    std::string command;       ///< the command line that gives these numbers again
    /// What else the numbers depend on, in snake_case: {"peer", "Embree 3.13.5, AVX2"}.
    std::vector<std::pair<std::string, std::string>> facts = {};
};

/// A further table of a report.
struct NamedTable {
    std::string key;   ///< snake_case; its name in JSON
    std::string title; ///< above it as text
    ReportTable table;
};

/// A titled table with findings in words.
struct Report {
    std::string title;
    ReportTable table;
    std::vector<NamedTable> more = {}; ///< left out in CSV
    std::vector<std::string> findings; ///< sentences under the table
    Provenance provenance;
};

enum class ReportFormat : std::uint8_t { table, csv, json };

/// `table`, `csv` or `json`; throws Error for another name.
[[nodiscard]] ReportFormat report_format(std::string_view name);

/// The version of the JSON layout, its key `schema_version`. Raised when a key changes its meaning
/// or goes.
inline constexpr int report_schema_version = 1;

/// Aligned columns under their names; a table of one row stands upright, name beside value.
/// Findings and provenance follow. Ends with a new line.
[[nodiscard]] std::string to_text(const Report& report);

/// RFC 4180, comma and full stop whatever the locale, numbers that read back as the same double,
/// one header line; the provenance follows the row's own columns in every row, so that tables from
/// many runs can be joined. Findings are left out.
[[nodiscard]] std::string to_csv(const Report& report);

/// One object: schema_version, title, provenance, rows (objects by column name), further tables
/// under their keys, findings.
[[nodiscard]] std::string to_json(const Report& report);

[[nodiscard]] std::string to_string(const Report& report, ReportFormat format);

/// The compiler of this build and the processor it runs on; the rest is the caller's.
[[nodiscard]] Provenance machine_provenance();

} // namespace raywise
