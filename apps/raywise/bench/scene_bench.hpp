// One scene of `raywise bench`: everything built, checked and timed, class by class.
#pragma once

#include "bench/class_bench.hpp"
#include "bench/rows.hpp"

#include <raywise/analysis/ray_workload.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/structure_choice.hpp>

#include <optional>
#include <string>
#include <vector>

namespace raywise::app {

struct BenchParams {
    WorkloadParams workload;
    std::vector<RayClass> classes;
    Effort effort;
    /// Of every area that may have it; absent: the accelerator chooses.
    std::optional<StructureKind> structure = {};
};

/// Throws Error where the parts do, Cancelled when stopped.
[[nodiscard]] SceneBench bench_scene(
    const std::string& title,
    const Scene& scene,
    const BenchParams& params,
    const BenchMachine& machine,
    const Progress& progress
);

} // namespace raywise::app
