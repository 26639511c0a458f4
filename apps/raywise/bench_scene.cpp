#include "bench_scene.hpp"
#include "peer/embree.hpp"

#include <raywise/analysis/answer_check.hpp>
#include <raywise/analysis/exact_oracle.hpp>
#include <raywise/analysis/side_by_side.hpp>
#include <raywise/analysis/stopwatch.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/hash.hpp>
#include <raywise/toplevel/accelerator.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <span>
#include <type_traits>

namespace raywise::app {

namespace {

/// Answers of all rays of a class; bool or Hit.
template <class Answer>
class Answers {
public:
    explicit Answers(std::size_t count)
        : items_(std::make_unique<Answer[]>(count)), count_(count) {}

    [[nodiscard]] std::span<Answer> all() const { return {items_.get(), count_}; }

private:
    std::unique_ptr<Answer[]> items_;
    std::size_t count_;
};

bool is_hit(bool answer) {
    return answer;
}

bool is_hit(const Hit& answer) {
    return answer.prim != no_prim;
}

bool query(const AreaHandle& area, const Ray& ray, bool) {
    return area.any_hit(ray);
}

bool query(const Accelerator& accelerator, const Ray& ray, bool) {
    return accelerator.any_hit(ray);
}

Hit query(const AreaHandle& area, const Ray& ray, const Hit&) {
    return area.closest_hit(ray).value_or(Hit{});
}

Hit query(const Accelerator& accelerator, const Ray& ray, const Hit&) {
    return accelerator.closest_hit(ray).value_or(Hit{});
}

template <class Structure>
void query_batch(
    const Structure& structure,
    std::span<const Ray> rays,
    std::span<bool> answers,
    const Executor& executor
) {
    structure.any_hits(rays, answers, executor);
}

template <class Structure>
void query_batch(
    const Structure& structure,
    std::span<const Ray> rays,
    std::span<Hit> answers,
    const Executor& executor
) {
    structure.closest_hits(rays, answers, executor);
}

void query_peer(
    const PeerRays& rays,
    const EmbreePeer& peer,
    const PeerCall& call,
    std::span<bool> answers,
    const Executor& executor
) {
    rays.occluded(peer, call, answers, executor);
}

void query_peer(
    const PeerRays& rays,
    const EmbreePeer& peer,
    const PeerCall& call,
    std::span<Hit> answers,
    const Executor& executor
) {
    rays.closest(peer, call, answers, executor);
}

template <class Structure, class Answer>
void query_singly(
    const Structure& structure,
    std::span<const Ray> rays,
    std::span<Answer> answers,
    const Executor& executor
) {
    constexpr std::size_t rays_per_chunk = 4096; // as on the peer's side
    executor.for_each_chunk(rays.size(), rays_per_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            answers[i] = query(structure, rays[i], Answer{});
    });
}

/// In which orders the peer may find neighbors among the rays of a class.
std::vector<RayOrder> orders_of(RayClass rays) {
    switch (rays) {
    case RayClass::sun:
    case RayClass::sun_disc_027:
    case RayClass::sun_disc_2:
        return {RayOrder::across_direction, RayOrder::origin};
    case RayClass::point_light:
    case RayClass::area_light:
        return {RayOrder::direction, RayOrder::origin};
    case RayClass::primary:
    case RayClass::thin_lens:
        return {RayOrder::direction};
    case RayClass::diffuse_bounce:
        break;
    }
    return {RayOrder::origin, RayOrder::octant_origin};
}

std::uint64_t hash_of(const ClassRays& rays) {
    std::uint64_t hash = 0;
    for (const EmitterRays& of_emitter : rays.emitters)
        hash = hash_elements(std::span<const Ray>(of_emitter.rays), hash);
    return hash;
}

/// Both of Embree's scenes.
struct Peers {
    EmbreePeer high;
    std::optional<EmbreePeer> robust;
};

/// One class of one scene: its rays on both sides.
template <class Answer>
class ClassBench {
public:
    ClassBench(
        const Accelerator& accelerator,
        const ClassRays& rays,
        const BenchParams& params,
        const BenchMachine& machine
    )
        : accelerator_(accelerator)
        , rays_(rays)
        , params_(params)
        , machine_(machine)
        , ours_(rays.count())
        , peers_(rays.count()) {
        for (const EmitterRays& of_emitter : rays.emitters)
            peer_rays_.emplace_back(of_emitter.rays);
    }

    /// Fills in everything but what names the scene.
    std::vector<BenchRow>
    run(const Peers& peers, const ExactOracle& oracle, const TriangleView& triangles) {
        BenchRow common;
        common.rays = rays_.rays;
        common.count = rays_.count();
        common.ray_hash = hash_of(rays_);
        check_oracle(oracle, triangles, common);
        count_steps(common);
        std::vector<BenchRow> rows;
        for (const Peer peer : {Peer::single, Peer::best}) {
            BenchRow row = common;
            row.peer = peer;
            measure(row, peers, oracle);
            rows.push_back(row);
        }
        return rows;
    }

private:
    void check_oracle(const ExactOracle& oracle, const TriangleView& triangles, BenchRow& row) {
        const std::size_t samples =
            params_.brute_force / triangles.size() / rays_.emitters.size() + 1;
        for (const EmitterRays& of_emitter : rays_.emitters) {
            row.brute_forced += std::min(samples, of_emitter.rays.size());
            const std::size_t wrong = count_wrong_oracle_answers(
                oracle, triangles, of_emitter.rays, samples, machine_.build
            );
            if (wrong > 0) throw Error("bench: the oracle differs from brute force");
        }
    }

    void count_steps(BenchRow& row) const {
        constexpr std::size_t every = 8;
        CountedQuery counts;
        std::size_t counted = 0;
        for (const EmitterRays& of_emitter : rays_.emitters) {
            for (std::size_t i = 0; i < of_emitter.rays.size(); i += every, ++counted) {
                const Ray& ray = of_emitter.rays[i];
                with_structure(of_emitter, [&](const auto& structure) {
                    if constexpr (std::is_same_v<Answer, bool>)
                        static_cast<void>(structure.any_hit(ray, counts));
                    else
                        static_cast<void>(structure.closest_hit(ray, counts));
                });
            }
        }
        const auto rays = static_cast<double>(std::max<std::size_t>(1, counted));
        row.node_visits = static_cast<double>(counts.node_visits()) / rays;
        row.triangle_tests = static_cast<double>(counts.prims) / rays;
    }

    void measure(BenchRow& row, const Peers& peers, const ExactOracle& oracle) {
        const bool is_batch = row.peer == Peer::best;
        const auto ours = [&] { is_batch ? trace_batches() : trace_singly(); };
        const PeerCall call = is_batch ? fastest_call(peers.high) : PeerCall{};
        const auto peer = [&] { trace_peer(peers.high, call); };
        row.peer_call = describe(call, !std::is_same_v<Answer, bool>);

        ours();
        peer();
        verify(oracle, row);
        if (row.count == 0) return;
        const SideBySide timed = time_side_by_side(ours, peer, timing());
        const auto rays = static_cast<double>(row.count);
        row.ours_mrays = rays / timed.first_ns * 1e3;
        row.peer_mrays = rays / timed.second_ns * 1e3;
        row.ratio = timed.ratio;
        row.spread = timed.spread;
        row.rounds = timed.rounds;
        if (peers.robust) {
            const PeerCall robust_call = is_batch ? fastest_call(*peers.robust) : PeerCall{};
            const auto robust = [&] { trace_peer(*peers.robust, robust_call); };
            row.ratio_robust = time_side_by_side(ours, robust, timing()).ratio;
        }
    }

    [[nodiscard]] SideBySideParams timing() const { return {.budget_ms = params_.budget_ms}; }

    void verify(const ExactOracle& oracle, BenchRow& row) const {
        std::size_t first = 0;
        std::size_t hits = 0;
        for (const EmitterRays& of_emitter : rays_.emitters) {
            const std::span<const Ray> rays(of_emitter.rays);
            const std::span<const Answer> ours = ours_.all().subspan(first, rays.size());
            const std::span<const Answer> peers = peers_.all().subspan(first, rays.size());
            if constexpr (std::is_same_v<Answer, bool>) {
                row.mismatches += count_wrong_occlusions(oracle, rays, ours, machine_.build);
                row.peer_wrong += count_wrong_occlusions(oracle, rays, peers, machine_.build);
            } else {
                row.mismatches += count_wrong_hits(oracle, rays, ours, machine_.build);
                row.peer_wrong += count_grossly_wrong_hits(oracle, rays, peers, machine_.build);
            }
            for (const Answer& answer : ours)
                hits += is_hit(answer) ? 1U : 0U;
            first += rays.size();
        }
        row.hit_share =
            static_cast<double>(hits) / static_cast<double>(std::max<std::size_t>(1, row.count));
    }

    /// The handle of the emitter's area, or the whole accelerator for rays of no area.
    template <class Use>
    void with_structure(const EmitterRays& of_emitter, const Use& use) const {
        if (of_emitter.area.empty())
            use(accelerator_);
        else
            use(accelerator_[of_emitter.area]);
    }

    /// Calls `trace(emitter, answers)` for each.
    template <class Trace>
    void for_each_emitter(const Answers<Answer>& answers, const Trace& trace) const {
        std::size_t first = 0;
        for (std::size_t e = 0; e < rays_.emitters.size(); ++e) {
            const std::size_t count = rays_.emitters[e].rays.size();
            trace(e, answers.all().subspan(first, count));
            first += count;
        }
    }

    void trace_singly() const {
        for_each_emitter(ours_, [&](std::size_t e, std::span<Answer> answers) {
            const EmitterRays& of_emitter = rays_.emitters[e];
            with_structure(of_emitter, [&](const auto& structure) {
                query_singly(structure, of_emitter.rays, answers, machine_.trace);
            });
        });
    }

    void trace_batches() const {
        for_each_emitter(ours_, [&](std::size_t e, std::span<Answer> answers) {
            const EmitterRays& of_emitter = rays_.emitters[e];
            with_structure(of_emitter, [&](const auto& structure) {
                query_batch(
                    structure, std::span<const Ray>(of_emitter.rays), answers, machine_.trace
                );
            });
        });
    }

    void trace_peer(const EmbreePeer& peer, const PeerCall& call) const {
        for_each_emitter(peers_, [&](std::size_t e, std::span<Answer> answers) {
            query_peer(peer_rays_[e], peer, call, answers, machine_.trace);
        });
    }

    /// The quicker of two passes decides.
    [[nodiscard]] PeerCall fastest_call(const EmbreePeer& peer) const {
        PeerCall best;
        double least = std::numeric_limits<double>::infinity();
        for (const PeerCall& call : peer_calls(orders_of(rays_.rays))) {
            for (int pass = 0; pass < 2; ++pass) {
                const Stopwatch watch;
                trace_peer(peer, call);
                const double time = watch.nanoseconds();
                if (time < least) {
                    least = time;
                    best = call;
                }
            }
        }
        return best;
    }

    const Accelerator& accelerator_;
    const ClassRays& rays_;
    const BenchParams& params_;
    const BenchMachine& machine_;
    Answers<Answer> ours_;
    Answers<Answer> peers_;
    std::vector<PeerRays> peer_rays_;
};

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
        Peers peers{build_peer(PeerQuality::high, false), {}};
        if (params_.is_robust_timed) peers.robust = build_peer(PeerQuality::high, true);
        static_cast<void>(build_peer(PeerQuality::medium, false));
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

    template <class IsOurs>
    void run_classes(const Peers& peers, const IsOurs& is_ours) {
        std::vector<const ClassRays*> classes;
        std::vector<InfluenceArea> areas;
        for (const ClassRays& rays : workload_.classes) {
            if (!is_ours(kind_of(rays.rays))) continue;
            classes.push_back(&rays);
            for (const EmitterRays& of_emitter : rays.emitters)
                for (const InfluenceArea& area : workload_.areas)
                    if (area.name == of_emitter.area) areas.push_back(area);
        }
        if (classes.empty()) return;
        step("building the accelerator");
        const Stopwatch watch;
        const std::size_t area_count = areas.size();
        const Accelerator accelerator =
            build_accelerator(scene_, std::move(areas), {}, machine_.build, progress_);
        add_build(
            fmt::format("accelerator of {} areas", area_count),
            watch.milliseconds(),
            accelerator.measure_memory().total()
        );
        for (const ClassRays* rays : classes)
            run_class(accelerator, *rays, peers);
    }

    void run_class(const Accelerator& accelerator, const ClassRays& rays, const Peers& peers) {
        step(std::string(name_of(rays.rays)));
        const auto add = [&](auto bench) {
            for (BenchRow& row : bench.run(peers, oracle_, scene_.view())) {
                row.scene = title_;
                row.scene_hash = hash_;
                row.triangles = scene_.triangles.size();
                bench_.rows.push_back(std::move(row));
            }
        };
        if (asks_closest(rays.rays))
            add(ClassBench<Hit>(accelerator, rays, params_, machine_));
        else
            add(ClassBench<bool>(accelerator, rays, params_, machine_));
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

std::string_view name_of(Peer peer) {
    return peer == Peer::single ? "embree_single" : "embree_best";
}

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
