// What `raywise bench` measured as a report: a table people can read, or all columns for programs.
#pragma once

#include "bench/rows.hpp"

#include <raywise/io/report.hpp>

#include <span>

namespace raywise::app {

/// What PERFORMANCE asks of a kind of rays beside a peer: a geometric mean over the rows, and the
/// least ratio of any scene.
struct Goal {
    double mean = 1;
    double worst = 1;
};

/// Nothing where no goal is set: general and near-affine rays in batches.
[[nodiscard]] std::optional<Goal> goal_of(RayKind kind, Peer peer);

/// One row per scene, class and peer; the builds as a second table. Findings: geometric means per
/// kind and peer with the worst scene and the goal beside, and what was verified.
[[nodiscard]] Report report_of(const SceneBench& bench, ReportFormat format, Provenance provenance);

} // namespace raywise::app
