// What `raywise bench` measured as a report: a table people can read, or all columns for programs.
#pragma once

#include "bench/rows.hpp"

#include <raywise/io/report.hpp>

#include <span>

namespace raywise::app {

/// One row per scene, class and peer; the builds as a second table. Findings: geometric means per
/// kind and peer with the worst scene and the goal beside, and what was verified.
[[nodiscard]] Report report_of(const SceneBench& bench, ReportFormat format, Provenance provenance);

} // namespace raywise::app
