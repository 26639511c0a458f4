// One scene of `raywise bench`: rays per second beside Embree, class by class, verified first.
#pragma once

#include <raywise/analysis/ray_workload.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::app {

struct BenchParams {
    WorkloadParams workload;
    std::vector<RayClass> classes;
    double budget_ms = 0;        ///< of each timed pair
    std::size_t brute_force = 0; ///< triangle tests that a class may take to check the oracle
    bool is_robust_timed = true; ///< also beside Embree's robust scene
};

/// Where rays are traced and structures are built.
struct BenchMachine {
    const Executor& build;
    const Executor& trace;
};

/// Which of Embree's ways stands beside us.
enum class Peer : std::uint8_t {
    single, ///< one ray per call on both sides
    best    ///< batches on both sides, sorting included; the fastest of Embree's calls
};

/// "embree_single", "embree_best".
[[nodiscard]] std::string_view name_of(Peer peer);

struct BenchRow {
    std::string scene;
    std::uint64_t scene_hash = 0;
    std::size_t triangles = 0;
    RayClass rays = RayClass::primary;
    Peer peer = Peer::single;
    std::size_t count = 0; ///< rays
    std::uint64_t ray_hash = 0;
    double hit_share = 0;
    double ours_mrays = 0;
    double peer_mrays = 0;
    double ratio = 0;  ///< ours over the peer's, median of pairs
    double spread = 0; ///< see SideBySide
    int rounds = 0;
    std::string peer_call;                     ///< what the peer was called with
    std::optional<double> ratio_robust = {};   ///< the same beside RTC_SCENE_FLAG_ROBUST
    std::optional<double> ratio_sorted = {};   ///< rays sorted beforehand on both sides
    std::optional<double> searched_mrays = {}; ///< ours when it must find the area itself
    std::size_t mismatches = 0;                ///< answers of ours that the oracle contradicts
    std::size_t peer_wrong = 0;                ///< answers of the peer's
    std::size_t brute_forced = 0;              ///< rays on which the oracle was checked
    double node_visits = 0;                    ///< per ray
    double triangle_tests = 0;                 ///< per ray
};

/// How long a structure takes to build and how large it is.
struct BuildRow {
    std::string scene;
    std::size_t triangles = 0;
    std::string structure;
    int threads = 1;
    double build_ms = 0;
    std::size_t bytes = 0;
};

struct SceneBench {
    std::vector<BenchRow> rows;
    std::vector<BuildRow> builds;
};

/// Builds both sides, checks every answer, times. Throws Error where the parts do, Cancelled when
/// stopped.
[[nodiscard]] SceneBench bench_scene(
    const std::string& title,
    const Scene& scene,
    const BenchParams& params,
    const BenchMachine& machine,
    const Progress& progress
);

} // namespace raywise::app
