#include <raywise/io/report.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/hash.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace raywise {

namespace {

using Json = nlohmann::ordered_json;

/// Calls `visit` with what the cell holds; numbers that are not finite count as absent.
template <class Visitor>
auto visit_cell(const Cell& cell, Visitor&& visit) {
    if (const double* number = std::get_if<double>(&cell);
        number != nullptr && !std::isfinite(*number))
        return visit(std::monostate{});
    return std::visit(visit, cell);
}

void require_rectangular(const ReportTable& table) {
    for (const auto& row : table.rows)
        if (row.size() != table.columns.size())
            throw Error("report: a row does not have one cell per column");
}

void require_rectangular(const Report& report) {
    require_rectangular(report.table);
    for (const NamedTable& more : report.more)
        require_rectangular(more.table);
}

/// Name and value of everything in the provenance that is known, in the order of all formats.
std::vector<std::pair<ColumnName, Cell>> provenance_cells(const Provenance& from) {
    std::vector<std::pair<ColumnName, Cell>> cells = {
        {"scene", from.scene},
        {"scene_hash", hex(from.scene_hash)},
        {"seed", static_cast<std::int64_t>(from.seed)},
        {"threads", std::int64_t{from.threads}},
        {"cost_node", from.constants.node},
        {"cost_prim", from.constants.prim},
        {"normalization", from.normalization},
        {"version", from.version},
        {"compiler", from.compiler},
        {"cpu", from.cpu},
        {"command", from.command},
    };
    for (const auto& [name, value] : from.facts)
        cells.emplace_back(name, value);
    return cells;
}

// ---- text

struct TextCell {
    std::string operator()(std::monostate) const { return "-"; }
    std::string operator()(bool value) const { return value ? "yes" : "no"; }
    std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
    std::string operator()(const std::string& value) const { return escaped(value, 80); }
    std::string operator()(double value) const {
        // Four digits are what a reader compares; whole numbers stay whole.
        const double size = std::abs(value);
        return size >= 1000 && size < 1e12 ? fmt::format("{:.0f}", value)
                                           : fmt::format("{:.4g}", value);
    }
};

/// Characters, not bytes.
std::size_t length(std::string_view text) {
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
    }));
}

std::string padded(const std::string& text, std::size_t width, bool to_the_right) {
    const std::string space(width - std::min(width, length(text)), ' ');
    return to_the_right ? space + text : text + space;
}

std::string upright_text(const ReportTable& table) {
    std::size_t width = 0;
    for (const ColumnName& name : table.columns)
        width = std::max(width, length(name));
    std::string text;
    for (std::size_t c = 0; c < table.columns.size(); ++c)
        text += padded(table.columns[c], width, false) + "  " +
                visit_cell(table.rows[0][c], TextCell{}) + "\n";
    return text;
}

std::string aligned_text(const ReportTable& table) {
    const std::size_t columns = table.columns.size();
    std::vector<std::vector<std::string>> lines(1, table.columns);
    std::vector<char> is_text(columns, 0);
    for (const auto& row : table.rows) {
        std::vector<std::string>& line = lines.emplace_back();
        for (std::size_t c = 0; c < columns; ++c) {
            line.push_back(visit_cell(row[c], TextCell{}));
            if (std::holds_alternative<std::string>(row[c])) is_text[c] = 1;
        }
    }
    std::vector<std::size_t> widths(columns, 0);
    for (const auto& line : lines)
        for (std::size_t c = 0; c < columns; ++c)
            widths[c] = std::max(widths[c], length(line[c]));

    std::string text;
    for (const auto& line : lines) {
        std::string row;
        for (std::size_t c = 0; c < columns; ++c)
            row += padded(line[c], widths[c], is_text[c] == 0) + "  ";
        row.erase(row.find_last_not_of(' ') + 1);
        text += row + "\n";
    }
    return text;
}

std::string provenance_text(const Provenance& from) {
    std::string text;
    if (!from.scene.empty())
        text += fmt::format(
            "scene {} (hash {}), seed {}\n",
            escaped(from.scene, 200),
            hex(from.scene_hash),
            from.seed
        );
    if (!from.normalization.empty())
        text += fmt::format(
            "costs: {:g} per box test, {:g} per triangle test; {}\n",
            from.constants.node,
            from.constants.prim,
            from.normalization
        );
    text += fmt::format(
        "raywise {}, {}, {}, threads {}\n", from.version, from.compiler, from.cpu, from.threads
    );
    for (const auto& [name, value] : from.facts)
        text += fmt::format("{}: {}\n", name, escaped(value, 200));
    return text;
}

// ---- CSV

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"') result += '"';
        result += c;
    }
    return result + '"';
}

struct CsvCell {
    std::string operator()(std::monostate) const { return {}; }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
    std::string operator()(double value) const { return fmt::format("{}", value); }
    std::string operator()(const std::string& value) const { return quoted(value); }
};

// ---- JSON

struct JsonCell {
    Json operator()(std::monostate) const { return nullptr; }
    Json operator()(bool value) const { return value; }
    Json operator()(std::int64_t value) const { return value; }
    Json operator()(double value) const { return value; }
    Json operator()(const std::string& value) const { return value; }
};

Json json_rows(const ReportTable& table) {
    Json rows = Json::array();
    for (const auto& row : table.rows) {
        Json& object = rows.emplace_back(Json::object());
        for (std::size_t c = 0; c < row.size(); ++c)
            object[table.columns[c]] = visit_cell(row[c], JsonCell{});
    }
    return rows;
}

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name"))
            if (const auto colon = line.find(": "); colon != std::string::npos)
                return line.substr(colon + 2);
    return "unknown processor";
}

std::string compiler_name() {
#if defined(__clang__)
    return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
    return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
    return "unknown compiler";
#endif
}

} // namespace

ReportFormat report_format(std::string_view name) {
    if (name == "table") return ReportFormat::table;
    if (name == "csv") return ReportFormat::csv;
    if (name == "json") return ReportFormat::json;
    throw Error("format '" + std::string(name) + "' is not table, csv or json");
}

void add_fact(ReportTable& table, ColumnName name, Cell value) {
    if (table.rows.empty()) table.rows.emplace_back();
    table.columns.push_back(std::move(name));
    table.rows.front().push_back(std::move(value));
}

void add_count(ReportTable& table, ColumnName name, std::uint64_t value) {
    add_fact(table, std::move(name), static_cast<std::int64_t>(value));
}

std::string to_text(const Report& report) {
    require_rectangular(report);
    std::string text = escaped(report.title) + "\n\n";
    text += report.table.rows.size() == 1 ? upright_text(report.table) : aligned_text(report.table);
    text += "\n";
    for (const NamedTable& more : report.more)
        text += escaped(more.title) + "\n\n" + aligned_text(more.table) + "\n";
    for (const std::string& finding : report.findings)
        text += escaped(finding, 1000) + "\n";
    if (!report.findings.empty()) text += "\n";
    return text + provenance_text(report.provenance);
}

std::string to_csv(const Report& report) {
    require_rectangular(report);
    const auto provenance = provenance_cells(report.provenance);
    std::string text;
    std::string tail;
    for (const ColumnName& name : report.table.columns)
        text += quoted(name) + ",";
    for (const auto& [name, cell] : provenance) {
        text += name + ",";
        tail += visit_cell(cell, CsvCell{}) + ",";
    }
    text.back() = tail.back() = '\n';
    for (const auto& row : report.table.rows) {
        for (const Cell& cell : row)
            text += visit_cell(cell, CsvCell{}) + ",";
        text += tail;
    }
    return text;
}

std::string to_json(const Report& report) {
    require_rectangular(report);
    Json document;
    document["schema_version"] = report_schema_version;
    document["title"] = report.title;
    Json& provenance = document["provenance"] = Json::object();
    for (const auto& [name, cell] : provenance_cells(report.provenance))
        provenance[name] = visit_cell(cell, JsonCell{});
    document["rows"] = json_rows(report.table);
    for (const NamedTable& more : report.more)
        document[more.key] = json_rows(more.table);
    document["findings"] = report.findings;
    // A file name may hold bytes that are not UTF-8; they must not cost the whole report.
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_string(const Report& report, ReportFormat format) {
    switch (format) {
    case ReportFormat::csv:
        return to_csv(report);
    case ReportFormat::json:
        return to_json(report);
    case ReportFormat::table:
        break;
    }
    return to_text(report);
}

Provenance machine_provenance() {
    Provenance provenance;
    provenance.compiler = compiler_name();
    provenance.cpu = processor_name();
    return provenance;
}

} // namespace raywise
