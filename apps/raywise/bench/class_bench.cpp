#include "bench/class_bench.hpp"
#include "bench/pinned.hpp"
#include "bench/race.hpp"
#include "bench/rows.hpp"
#include "peer/embree.hpp"

#include <raywise/analysis/answer_check.hpp>
#include <raywise/analysis/ray_class.hpp>
#include <raywise/analysis/ray_order.hpp>
#include <raywise/analysis/ray_workload.hpp>
#include <raywise/analysis/side_by_side.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/hash.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/toplevel/served.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace raywise::app {

namespace {

ClassRays sorted(const ClassRays& rays) {
    ClassRays result = rays;
    const RayOrder order = orders_of(rays.rays).front();
    for (std::size_t e = 0; e < rays.emitters.size(); ++e) {
        const std::vector<Ray>& given = rays.emitters[e].rays;
        std::size_t next = 0;
        for (const std::uint32_t place : sorted_places(given, order))
            result.emitters[e].rays[next++] = given[place];
    }
    return result;
}

std::uint64_t hash_of(const ClassRays& rays) {
    std::uint64_t hash = 0;
    for (const EmitterRays& of_emitter : rays.emitters)
        hash = hash_elements(std::span<const Ray>(of_emitter.rays), hash);
    return hash;
}

/// The rows of one class.
template <class Answer>
class ClassBench {
public:
    ClassBench(
        const Contest& contest,
        const ClassRays& rays,
        const Effort& effort,
        const BenchMachine& machine
    )
        : contest_(contest)
        , rays_(rays)
        , effort_(effort)
        , machine_(machine)
        , race_(contest, rays, machine) {}

    std::vector<BenchRow> run() {
        BenchRow common;
        common.rays = rays_.rays;
        common.count = rays_.count();
        common.ray_hash = hash_of(rays_);
        common.hit_share = race_.hit_share();
        common.structure = race_.structures();
        common.brute_forced = check_oracle();
        CountedQuery counts;
        const auto counted =
            static_cast<double>(std::max<std::size_t>(1, race_.count_steps(counts)));
        common.node_visits = static_cast<double>(counts.node_visits()) / counted;
        common.triangle_tests = static_cast<double>(counts.prims) / counted;
        return {measure_single(common), measure_best(common)};
    }

private:
    /// The number of rays that it was checked on.
    [[nodiscard]] std::size_t check_oracle() const {
        const std::size_t samples =
            effort_.brute_force / contest_.triangles.size() / rays_.emitters.size() + 1;
        std::size_t checked = 0;
        for (const EmitterRays& of_emitter : rays_.emitters) {
            checked += std::min(samples, of_emitter.rays.size());
            const std::size_t wrong = count_wrong_oracle_answers(
                contest_.oracle, contest_.triangles, of_emitter.rays, samples, machine_.build
            );
            if (wrong > 0) throw Error("bench: brute force contradicts the oracle");
        }
        return checked;
    }

    [[nodiscard]] BenchRow measure_single(BenchRow row) const {
        row.peer = Peer::single;
        const auto ours = [&] { race_.trace_singly(contest_.accelerator); };
        const auto peer = [&] { race_.trace_peer(contest_.peers.high, {}); };
        measure(row, ours, peer, {});
        if (row.count == 0) return row;
        if (effort_.is_thorough) {
            measure_sorted(row);
            const auto robust = [&] { race_.trace_peer(*contest_.peers.robust, {}); };
            row.ratio_robust = timed(ours, robust).ratio;
            if (contest_.fast != nullptr) {
                const auto fast = [&] { race_.trace_singly(*contest_.fast); };
                measure_fast(row, fast, peer, robust);
            }
        }
        if (kind_of(rays_.rays) == RayKind::general) return row;
        const auto searching = [&] { race_.trace_searching(); };
        searching();
        row.mismatches += race_.wrong_answers();
        row.searched_mrays =
            static_cast<double>(row.count) / timed(ours, searching).second_ns * 1e3;
        return row;
    }

    [[nodiscard]] BenchRow measure_best(BenchRow row) const {
        row.peer = Peer::best;
        const PeerCall call = race_.fastest_call(contest_.peers.high);
        const auto ours = [&] { race_.trace_in_batches(contest_.accelerator); };
        const auto peer = [&] { race_.trace_peer(contest_.peers.high, call); };
        measure(row, ours, peer, call);
        if (row.count == 0 || !effort_.is_thorough) return row;
        const PeerCall robust_call = race_.fastest_call(*contest_.peers.robust);
        const auto robust = [&] { race_.trace_peer(*contest_.peers.robust, robust_call); };
        row.ratio_robust = timed(ours, robust).ratio;
        if (contest_.fast != nullptr) {
            const auto fast = [&] { race_.trace_in_batches(*contest_.fast); };
            measure_fast(row, fast, peer, robust);
        }
        return row;
    }

    /// Our fast mode beside both of the peer's.
    template <class Fast, class Theirs, class Robust>
    void
    measure_fast(BenchRow& row, const Fast& fast, const Theirs& peer, const Robust& robust) const {
        fast();
        row.fast_wrong = race_.wrong_fast_answers();
        row.ratio_fast = timed(fast, peer).ratio;
        row.ratio_fast_robust = timed(fast, robust).ratio;
    }

    template <class Ours, class Theirs>
    void measure(BenchRow& row, const Ours& ours, const Theirs& peer, const PeerCall& call) const {
        row.peer_call = describe(call, !std::is_same_v<Answer, bool>);
        ours();
        peer();
        row.mismatches = race_.wrong_answers();
        row.peer_wrong = race_.wrong_peer_answers();
        if (row.count == 0) return;
        const SideBySide result = timed(ours, peer);
        const auto rays = static_cast<double>(row.count);
        row.ours_mrays = rays / result.first_ns * 1e3;
        row.peer_mrays = rays / result.second_ns * 1e3;
        row.ratio = result.ratio;
        row.spread = result.spread;
        row.rounds = result.rounds;
    }

    /// One ray per call, of rays that lie in order.
    void measure_sorted(BenchRow& row) const {
        const ClassRays in_order = sorted(rays_);
        const Race<Answer> race(contest_, in_order, machine_);
        const auto ours = [&] { race.trace_singly(contest_.accelerator); };
        const auto peer = [&] { race.trace_peer(contest_.peers.high, {}); };
        row.ratio_sorted = timed(ours, peer).ratio;
        row.mismatches += race.wrong_answers();
    }

    template <class First, class Second>
    [[nodiscard]] SideBySide timed(const First& first, const Second& second) const {
        const Pinned pinned(machine_.trace);
        return time_side_by_side(
            first,
            second,
            {.budget_ms = effort_.budget_ms,
             .timed_by = machine_.trace.threads() == 1 ? TimedBy::thread : TimedBy::wall}
        );
    }

    const Contest& contest_;
    const ClassRays& rays_;
    const Effort& effort_;
    const BenchMachine& machine_;
    Race<Answer> race_;
};

} // namespace

std::vector<BenchRow> bench_class(
    const Contest& contest,
    const ClassRays& rays,
    const Effort& effort,
    const BenchMachine& machine
) {
    return asks_closest(rays.rays) ? ClassBench<Hit>(contest, rays, effort, machine).run()
                                   : ClassBench<bool>(contest, rays, effort, machine).run();
}

} // namespace raywise::app
