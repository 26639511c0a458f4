// What `raywise bench` measures, as plain data.
#pragma once

#include <raywise/analysis/ray_workload.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::app {

/// Which of Embree's ways stands beside us.
enum class Peer : std::uint8_t {
    single, ///< one ray per call on both sides
    best    ///< batches on both sides, sorting included; the fastest of Embree's calls
};

/// "embree_single", "embree_best".
[[nodiscard]] constexpr std::string_view name_of(Peer peer) {
    return peer == Peer::single ? "embree_single" : "embree_best";
}

/// Rays of one class in one scene, traced by both sides.
struct BenchRow {
    std::string scene;
    std::uint64_t scene_hash = 0;
    std::size_t triangles = 0;
    RayClass rays = RayClass::primary;
    Peer peer = Peer::single;
    std::size_t count = 0; ///< rays; with none, nothing is timed
    std::uint64_t ray_hash = 0;
    double hit_share = 0;
    double ours_mrays = 0;
    double peer_mrays = 0;
    double ratio = 0;  ///< ours over the peer's, median of pairs
    double spread = 0; ///< see SideBySide
    int rounds = 0;
    std::string structure;                        ///< what ours traced through, of each emitter
    std::string peer_call;                        ///< what the peer was called with
    std::optional<double> ratio_robust = {};      ///< the same beside RTC_SCENE_FLAG_ROBUST
    std::optional<double> ratio_fast = {};        ///< ours in TraceMode::fast beside the peer
    std::optional<double> ratio_fast_robust = {}; ///< the same beside RTC_SCENE_FLAG_ROBUST
    std::optional<std::size_t> fast_wrong = {};   ///< answers of TraceMode::fast, as peer_wrong
    std::optional<double> ratio_sorted = {};      ///< rays sorted beforehand, for both sides
    std::optional<double> searched_mrays = {};    ///< ours when it must find the area itself
    std::size_t mismatches = 0;                   ///< answers of ours that the oracle contradicts
    std::size_t peer_wrong = 0;                   ///< answers of the peer's
    std::size_t brute_forced = 0;                 ///< rays on which the oracle itself was checked
    double node_visits = 0;                       ///< per ray
    double triangle_tests = 0;                    ///< per ray
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

/// Exact rays after which building an area's structure and tracing through it beats an already
/// built Embree scene, everything on the tracing threads.
struct BreakEvenRow {
    std::string scene;
    RayClass rays = RayClass::sun;
    Peer peer = Peer::single;
    double build_ms = 0;                          ///< of one emitter's structure, mean
    double ours_ns = 0;                           ///< per ray
    double peer_ns = 0;                           ///< per ray
    std::optional<double> rays_per_triangle = {}; ///< absent: never
};

/// What the machine's memory allows: a query needs at least one cell and one triangle record, two
/// dependent loads.
struct LimitRow {
    std::string scene;
    std::size_t bytes = 0;      ///< of one exact area's structure
    double load_ns = 0;         ///< of a dependent random load in so many bytes
    double stream_gb_per_s = 0; ///< of a pass over so many bytes
    double ours_ns = 0;         ///< per exact ray, one per call, geometric mean of the classes
    double share = 0;           ///< two loads over that
};

/// How the time per ray grows over a series of one generated scene.
struct GrowthRow {
    std::string scene; ///< "city"
    RayClass rays = RayClass::sun;
    Peer peer = Peer::single;
    std::size_t from_triangles = 0;
    std::size_t to_triangles = 0;
    double ours = 0;        ///< time per ray in the largest over that in the smallest
    double peer_growth = 0; ///< the same of the peer
};

/// What several threads gain over one.
struct ThreadRow {
    std::string scene;
    std::string work;
    int threads = 1;
    double one_ms = 0;
    double all_ms = 0;
    double speedup = 0;
    double spread = 0; ///< see SideBySide
};

struct SceneBench {
    std::vector<BenchRow> rows;
    std::vector<BuildRow> builds;
    std::vector<BreakEvenRow> break_even;
    std::vector<LimitRow> limits;
    std::vector<GrowthRow> growth;
    std::vector<ThreadRow> threads;
};

} // namespace raywise::app
