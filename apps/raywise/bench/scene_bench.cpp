#include "bench/scene_bench.hpp"

#include <raywise/analysis/stopwatch.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace raywise::app {

namespace {

/// One scene, step by step.
class SceneBencher {
public:
    SceneBencher(
        const std::string& title,
        const Scene& scene,
        const BenchParams& params,
        const BenchMachine& machine,
        const Progress& progress
    )
        : title_(title)
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
        std::stable_sort(
            bench_.rows.begin(),
            bench_.rows.end(),
            [](const BenchRow& a, const BenchRow& b) { return a.rays < b.rays; }
        );
        return std::move(bench_);
    }

private:
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

    Accelerator build(const std::string& name, std::vector<InfluenceArea> areas) {
        step("building " + name);
        const Stopwatch watch;
        Accelerator accelerator =
            build_accelerator(scene_, std::move(areas), {}, machine_.build, progress_);
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
                for (const InfluenceArea& area : workload_.areas)
                    if (area.name == of_emitter.area) areas.push_back(area);
        }
        if (classes.empty()) return;
        const std::string name = fmt::format("accelerator of {} areas", areas.size());
        const Accelerator accelerator = build(name, std::move(areas));
        const Contest contest{accelerator, peers, oracle_, scene_.view()};
        for (const ClassRays* rays : classes) {
            step(std::string(name_of(rays->rays)));
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
