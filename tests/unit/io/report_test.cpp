// Oracles: hand-written expected texts, and the JSON library reading back what the report wrote.
#include <raywise/io/report.hpp>

#include <raywise/core/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace raywise {
namespace {

using testing::HasSubstr;

Report sample_report() {
    Report report;
    report.title = "Two areas";
    report.table.columns = {"area", "rays", "cost"};
    report.table.rows = {
        {std::string("sun"), std::int64_t{1000}, 12.5},
        {std::string("lamp, \"left\""), std::int64_t{7}, std::monostate{}},
    };
    report.findings = {"The sun wins."};
    report.provenance.version = "1.2";
    report.provenance.cpu = "a, b";
    report.provenance.scene = "x.ply";
    report.provenance.scene_hash = 255;
    return report;
}

TEST(Report, TableAlignsNumbersRightAndTextLeft) {
    EXPECT_THAT(
        to_text(sample_report()),
        HasSubstr("area          rays  cost\n"
                  "sun           1000  12.5\n"
                  "lamp, \"left\"     7     -\n")
    );
}

TEST(Report, TableOfOneRowStandsUpright) {
    Report report = sample_report();
    report.table.rows.pop_back();
    EXPECT_THAT(to_text(report), HasSubstr("area  sun\nrays  1000\ncost  12.5\n"));
}

TEST(Report, TableWithoutRowsIsItsHeader) {
    Report report = sample_report();
    report.table.rows.clear();
    EXPECT_THAT(to_text(report), HasSubstr("area  rays  cost\n"));
}

TEST(Report, ControlCharactersOfANameDoNotReachTheTerminal) {
    Report report = sample_report();
    report.provenance.scene = "a\x1b[31m\n.ply";
    report.table.rows[0][0] = std::string("\x07");
    const std::string text = to_text(report);
    EXPECT_EQ(text.find('\x1b'), std::string::npos);
    EXPECT_EQ(text.find('\x07'), std::string::npos);
}

TEST(Report, CsvQuotesAsRfc4180AndRepeatsTheProvenanceInEveryRow) {
    const std::string csv = to_csv(sample_report());
    EXPECT_THAT(csv, testing::StartsWith("area,rays,cost,scene,scene_hash,"));
    EXPECT_THAT(csv, HasSubstr("\nsun,1000,12.5,x.ply,00000000000000ff,"));
    EXPECT_THAT(csv, HasSubstr("\n\"lamp, \"\"left\"\"\",7,,x.ply,"));
    EXPECT_THAT(csv, HasSubstr(",\"a, b\","));
}

TEST(Report, JsonReadsBackAsTheSameNumbers) {
    Report report = sample_report();
    const double number = 0.1 + 0.2;
    report.table.rows[0][2] = number;
    const auto json = nlohmann::json::parse(to_json(report));
    EXPECT_EQ(json["schema_version"], report_schema_version);
    EXPECT_EQ(json["rows"][0]["cost"].get<double>(), number);
    EXPECT_EQ(json["rows"][1]["area"], "lamp, \"left\"");
    EXPECT_TRUE(json["rows"][1]["cost"].is_null());
    EXPECT_EQ(json["provenance"]["scene_hash"], "00000000000000ff");
    EXPECT_EQ(json["findings"][0], "The sun wins.");
}

TEST(Report, NumbersThatAreNotFiniteAreAbsentInEveryFormat) {
    Report report = sample_report();
    for (const double number : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        report.table.rows[0][2] = number;
        EXPECT_TRUE(nlohmann::json::parse(to_json(report))["rows"][0]["cost"].is_null());
        EXPECT_THAT(to_csv(report), HasSubstr("\nsun,1000,,"));
        EXPECT_THAT(to_text(report), HasSubstr("sun           1000     -\n"));
    }
}

TEST(Report, JsonOfBytesThatAreNotUtf8IsStillJson) {
    Report report = sample_report();
    report.provenance.scene = "\xFF\xFE.ply";
    EXPECT_TRUE(nlohmann::json::accept(to_json(report)));
}

TEST(Report, RowOfTheWrongLengthIsRefused) {
    Report report = sample_report();
    report.table.rows[0].pop_back();
    EXPECT_THROW((void)to_text(report), Error);
    EXPECT_THROW((void)to_csv(report), Error);
    EXPECT_THROW((void)to_json(report), Error);
}

TEST(Report, FormatsAreNamedAndOthersRefused) {
    EXPECT_EQ(report_format("csv"), ReportFormat::csv);
    EXPECT_EQ(to_string(sample_report(), ReportFormat::json), to_json(sample_report()));
    EXPECT_THROW((void)report_format("xml"), Error);
}

TEST(Report, MachineHasACompilerAndAProcessor) {
    EXPECT_FALSE(machine_provenance().compiler.empty());
    EXPECT_FALSE(machine_provenance().cpu.empty());
}

} // namespace
} // namespace raywise
