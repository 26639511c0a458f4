#include "bench/class_bench.hpp"
#include "bench/rows.hpp"
#include "bench/scene_bench.hpp"
#include "peer/embree.hpp"

#include <raywise/analysis/memory_speed.hpp>
#include <raywise/analysis/ray_class.hpp>
#include <raywise/analysis/ray_workload.hpp>
#include <raywise/analysis/statistics.hpp>
#include <raywise/analysis/stopwatch.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/pencil/pencil.hpp>
#include <raywise/pencil/pencil_grid.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/pencil_of.hpp>
#include <raywise/toplevel/structure_choice.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace raywise::app {

namespace {

/// One scene, step by step.
class SceneBencher {
public:
    SceneBencher(
        std::string title,
        const Scene& scene,
        const BenchParams& params,
        const BenchMachine& machine,
        const Progress& progress
    )
        : title_(std::move(title))
        , scene_(scene)
        , params_(params)
        , machine_(machine)
        , progress_(progress)
        , oracle_(scene.view(), machine.build)
        , workload_(make_workload(scene, oracle_, params.classes, params.workload, machine.build))
        , hash_(content_hash(scene)) {}

    SceneBench run() {
        const Peers peers = build_peers();
        build_global();
        // Exact areas stand beside the rays of no area; blurred ones have an accelerator of their
        // own, so that the structures of all areas need not be in memory at once.
        run_classes(peers, [](RayKind kind) { return kind != RayKind::near_affine; });
        run_classes(peers, [](RayKind kind) { return kind == RayKind::near_affine; });
        std::sort(bench_.rows.begin(), bench_.rows.end(), [](const BenchRow& a, const BenchRow& b) {
            return std::pair(a.rays, a.peer) < std::pair(b.rays, b.peer);
        });
        measure_grids();
        return std::move(bench_);
    }

private:
    /// The pencil grid of each exact area, as the accelerator builds it, on its own.
    void measure_grids() {
        const std::span<const BenchRow> rows(bench_.rows);
        std::size_t largest = 0;
        std::vector<double> exact_ns;
        for (const ClassRays& rays : workload_.classes) {
            if (kind_of(rays.rays) != RayKind::exact) continue;
            const GridCost cost = build_grids(rays);
            largest = std::max(largest, cost.bytes);
            add_build(fmt::format("pencil grid, {}", name_of(rays.rays)), cost.all_ms, cost.bytes);
            for (const BenchRow& row : rows) {
                if (row.rays != rays.rays || row.rounds == 0) continue;
                bench_.break_even.push_back(break_even_of(row, cost.traced_ms));
                if (row.peer == Peer::single) exact_ns.push_back(1e3 / row.ours_mrays);
            }
        }
        if (!exact_ns.empty()) bench_.limits.push_back(limit_of(largest, exact_ns));
    }

    /// Means over the emitters of a class that were built.
    struct GridCost {
        double all_ms = 0;    ///< on the building threads
        double traced_ms = 0; ///< on the tracing threads
        std::size_t bytes = 0;
    };

    GridCost build_grids(const ClassRays& rays) {
        step(fmt::format("building pencil grids, {}", name_of(rays.rays)));
        // The last one stands inside the scene, the costlier place; its low sun is no cheaper.
        const std::span<const EmitterRays> all(rays.emitters);
        const auto emitters = params_.effort.is_thorough ? all : all.last(1);
        GridCost cost;
        for (const EmitterRays& of_emitter : emitters) {
            const Pencil pencil = pencil_of(area_named(of_emitter.area)).value();
            const Stopwatch quick;
            const PencilGrid grid = build_pencil_grid(scene_.view(), pencil, {}, machine_.build);
            cost.all_ms += quick.milliseconds();
            cost.bytes += grid.size_in_bytes();
            const Stopwatch slow;
            static_cast<void>(build_pencil_grid(scene_.view(), pencil, {}, machine_.trace));
            cost.traced_ms += slow.milliseconds();
        }
        cost.all_ms /= static_cast<double>(emitters.size());
        cost.traced_ms /= static_cast<double>(emitters.size());
        cost.bytes /= emitters.size();
        return cost;
    }

    [[nodiscard]] BreakEvenRow break_even_of(const BenchRow& row, double build_ms) const {
        BreakEvenRow result{title_, row.rays, row.peer, build_ms, 1e3 / row.ours_mrays, 0, {}};
        result.peer_ns = result.ours_ns * row.ratio;
        const double gain = result.peer_ns - result.ours_ns;
        if (gain > 0)
            result.rays_per_triangle =
                build_ms * 1e6 / gain / static_cast<double>(scene_.triangles.size());
        return result;
    }

    [[nodiscard]] LimitRow limit_of(std::size_t bytes, std::span<const double> exact_ns) const {
        LimitRow row;
        row.scene = title_;
        row.bytes = bytes;
        row.load_ns = measure_load_ns(bytes);
        row.stream_gb_per_s = measure_stream_gb_per_s(bytes);
        row.ours_ns = geometric_mean(exact_ns);
        row.share = 2 * row.load_ns / row.ours_ns;
        return row;
    }

    [[nodiscard]] const InfluenceArea& area_named(const std::string& name) const {
        return *std::find_if(
            workload_.areas.begin(),
            workload_.areas.end(),
            [&](const InfluenceArea& area) { return area.name == name; }
        );
    }

    Peers build_peers() {
        static_cast<void>(build_peer(PeerQuality::medium, false));
        Peers peers{build_peer(PeerQuality::high, false), {}};
        if (params_.effort.is_thorough) peers.robust = build_peer(PeerQuality::high, true);
        return peers;
    }

    EmbreePeer build_peer(PeerQuality quality, bool is_robust) {
        const std::string name = fmt::format(
            "Embree {}{}",
            quality == PeerQuality::high ? "HIGH" : "MEDIUM",
            is_robust ? " robust" : ""
        );
        step("building " + name);
        EmbreePeer peer(
            scene_,
            {.quality = quality, .is_robust = is_robust, .threads = machine_.build.threads()}
        );
        add_build(name, peer.build_ms(), peer.bytes());
        return peer;
    }

    static bool may_have(const InfluenceArea& area, StructureKind structure) {
        const bool is_for_exact_areas =
            structure == StructureKind::pencil_grid || structure == StructureKind::inversion;
        if (structure == StructureKind::framed_tree)
            return std::holds_alternative<ParallelDistribution>(area.distribution);
        return !is_for_exact_areas || pencil_of(area).has_value();
    }

    Accelerator build(const std::string& name, std::vector<InfluenceArea> areas) {
        step("building " + name);
        AcceleratorParams params;
        params.use.expected_rays = 1e9; // what is traced is compared, not what is built
        for (const InfluenceArea& area : areas) {
            AreaUse& use = params.uses[area.name];
            use = params.use;
            if (params_.structure && may_have(area, *params_.structure))
                use.structure = params_.structure;
        }
        const Stopwatch watch;
        Accelerator accelerator =
            build_accelerator(scene_, std::move(areas), params, machine_.build, progress_);
        add_build(name, watch.milliseconds(), accelerator.measure_memory().total());
        return accelerator;
    }

    void build_global() { static_cast<void>(build("global tree", {})); }

    template <class IsWanted>
    void run_classes(const Peers& peers, const IsWanted& is_wanted) {
        std::vector<const ClassRays*> classes;
        std::vector<InfluenceArea> areas;
        for (const ClassRays& rays : workload_.classes) {
            if (!is_wanted(kind_of(rays.rays))) continue;
            classes.push_back(&rays);
            for (const EmitterRays& of_emitter : rays.emitters)
                if (!of_emitter.area.empty()) areas.push_back(area_named(of_emitter.area));
        }
        if (classes.empty()) return;
        const std::string name = fmt::format("accelerator of {} areas", areas.size());
        const Accelerator accelerator = build(name, std::move(areas));
        std::optional<Accelerator> fast;
        if (params_.effort.is_thorough) fast = accelerator.with_trace_mode(TraceMode::fast);
        for (const ClassRays* rays : classes) {
            step(std::string(name_of(rays->rays)));
            // Exact rays go through grids, which know no other mode.
            const bool has_fast = fast && kind_of(rays->rays) != RayKind::exact;
            const Contest contest{
                accelerator, has_fast ? &*fast : nullptr, peers, oracle_, scene_.view()
            };
            for (BenchRow& row : bench_class(contest, *rays, params_.effort, machine_)) {
                row.scene = title_;
                row.scene_hash = hash_;
                row.triangles = scene_.triangles.size();
                bench_.rows.push_back(std::move(row));
            }
        }
    }

    void add_build(const std::string& structure, double ms, std::size_t bytes) {
        bench_.builds.push_back(
            {title_, scene_.triangles.size(), structure, machine_.build.threads(), ms, bytes}
        );
    }

    void step(const std::string& what) { progress_.step(title_ + ": " + what, ++steps_, 0); }

    std::string title_;
    const Scene& scene_;
    const BenchParams& params_;
    const BenchMachine& machine_;
    const Progress& progress_;
    ExactOracle oracle_;
    Workload workload_;
    std::uint64_t hash_;
    std::uint64_t steps_ = 0;
    SceneBench bench_;
};

} // namespace

SceneBench bench_scene(
    const std::string& title,
    const Scene& scene,
    const BenchParams& params,
    const BenchMachine& machine,
    const Progress& progress
) {
    return SceneBencher(title, scene, params, machine, progress).run();
}

} // namespace raywise::app
