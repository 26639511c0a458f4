// One class of rays in one scene: both sides checked, then timed.
#pragma once

#include "bench/rows.hpp"
#include "peer/embree.hpp"

#include <raywise/analysis/exact_oracle.hpp>
#include <raywise/analysis/ray_workload.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/toplevel/accelerator.hpp>

#include <cstddef>
#include <optional>
#include <vector>

namespace raywise::app {

/// How much is measured.
struct Effort {
    double budget_ms = 0;        ///< of each timed pair
    std::size_t brute_force = 0; ///< triangle tests that a class may take to check the oracle
    bool is_thorough = true;     ///< also sorted rays, Embree's robust scene, and our fast mode
};

/// Where structures are built and answers checked, and where rays are traced.
struct BenchMachine {
    const Executor& build;
    const Executor& trace;
};

/// Embree's scenes.
struct Peers {
    EmbreePeer high;
    std::optional<EmbreePeer> robust;
};

/// Who answers the rays of a class.
struct Contest {
    const Accelerator& accelerator; ///< with the areas that the class names
    const Accelerator* fast;        ///< the same in TraceMode::fast; null: not measured
    const Peers& peers;
    const ExactOracle& oracle;
    TriangleView triangles;
};

/// One row for each Peer; what names the scene is left to the caller. Throws Error when brute force
/// contradicts the oracle.
[[nodiscard]] std::vector<BenchRow> bench_class(
    const Contest& contest,
    const ClassRays& rays,
    const Effort& effort,
    const BenchMachine& machine
);

} // namespace raywise::app
