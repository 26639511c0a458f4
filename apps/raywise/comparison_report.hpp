// A comparison as a report: a table people can read, or all columns for programs.
#pragma once

#include <raywise/analysis/comparison.hpp>
#include <raywise/io/report.hpp>

namespace raywise::app {

/// One row per area and pair. The table format shows the columns that decide; csv and json show
/// all, the facts of the area repeated in its rows. Findings: one verdict per area, the means over
/// areas, what was verified. Scene, hash, constants and normalization of the provenance are filled
/// in; the rest is the caller's.
[[nodiscard]] Report
report_of(const Comparison& comparison, ReportFormat format, Provenance provenance);

} // namespace raywise::app
