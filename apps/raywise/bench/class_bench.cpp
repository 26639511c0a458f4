#include "bench/class_bench.hpp"
#include "bench/pinned.hpp"

#include <raywise/analysis/answer_check.hpp>
#include <raywise/analysis/ray_order.hpp>
#include <raywise/analysis/side_by_side.hpp>
#include <raywise/analysis/stopwatch.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/hash.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
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

// The same questions to whatever answers them, for shadow rays (bool) and closest hits (Hit).

bool is_hit(bool answer) {
    return answer;
}

bool is_hit(const Hit& answer) {
    return answer.prim != no_prim;
}

template <class Structure>
void ask(const Structure& structure, const Ray& ray, bool& answer) {
    answer = structure.any_hit(ray);
}

template <class Structure>
void ask(const Structure& structure, const Ray& ray, Hit& answer) {
    const std::optional<Hit> hit = structure.closest_hit(ray);
    answer = hit ? *hit : Hit{};
}

template <class Structure>
void ask_all(
    const Structure& structure,
    std::span<const Ray> rays,
    std::span<bool> answers,
    const Executor& executor
) {
    structure.any_hits(rays, answers, executor);
}

template <class Structure>
void ask_all(
    const Structure& structure,
    std::span<const Ray> rays,
    std::span<Hit> answers,
    const Executor& executor
) {
    structure.closest_hits(rays, answers, executor);
}

void ask_oracle(
    const ExactOracle& oracle,
    std::span<const Ray> rays,
    std::span<bool> answers,
    const Executor& executor
) {
    oracle.any_hits(rays, answers, executor);
}

void ask_oracle(
    const ExactOracle& oracle,
    std::span<const Ray> rays,
    std::span<Hit> answers,
    const Executor& executor
) {
    oracle.closest_hits(rays, answers, executor);
}

void ask_peer(
    const PeerRays& rays,
    const EmbreePeer& peer,
    const PeerCall& call,
    std::span<bool> answers,
    const Executor& executor
) {
    rays.occluded(peer, call, answers, executor);
}

void ask_peer(
    const PeerRays& rays,
    const EmbreePeer& peer,
    const PeerCall& call,
    std::span<Hit> answers,
    const Executor& executor
) {
    rays.closest(peer, call, answers, executor);
}

template <class Structure, class Answer>
void ask_singly(
    const Structure& structure,
    std::span<const Ray> rays,
    std::span<Answer> answers,
    const Executor& executor
) {
    constexpr std::size_t rays_per_chunk = 4096; // as on the peer's side
    executor.for_each_chunk(rays.size(), rays_per_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            ask(structure, rays[i], answers[i]);
    });
}

/// In which orders neighbors may be found among the rays of a class, the likeliest first.
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

/// Rays of a class with what both sides answer. Each emitter's rays are a pass of their own.
template <class Answer>
class Race {
public:
    Race(const Contest& contest, const ClassRays& rays, const BenchMachine& machine)
        : contest_(contest)
        , rays_(rays)
        , machine_(machine)
        , ours_(rays.count())
        , peers_(rays.count())
        , right_(rays.count()) {
        for (const EmitterRays& of_emitter : rays.emitters)
            peer_rays_.emplace_back(of_emitter.rays);
        for_each_emitter(right_, [&](std::size_t e, std::span<Answer> answers) {
            ask_oracle(contest.oracle, rays.emitters[e].rays, answers, machine.build);
        });
    }

    // What can be timed.

    void trace_singly() const {
        for_each_emitter(ours_, [&](std::size_t e, std::span<Answer> answers) {
            with_structure(rays_.emitters[e], [&](const auto& structure) {
                ask_singly(structure, rays_.emitters[e].rays, answers, machine_.trace);
            });
        });
    }

    void trace_in_batches() const {
        for_each_emitter(ours_, [&](std::size_t e, std::span<Answer> answers) {
            with_structure(rays_.emitters[e], [&](const auto& structure) {
                ask_all(structure, rays_.emitters[e].rays, answers, machine_.trace);
            });
        });
    }

    /// As rays of which nobody knows the area.
    void trace_searching() const {
        for_each_emitter(ours_, [&](std::size_t e, std::span<Answer> answers) {
            ask_singly(contest_.accelerator, rays_.emitters[e].rays, answers, machine_.trace);
        });
    }

    void trace_peer(const EmbreePeer& peer, const PeerCall& call) const {
        for_each_emitter(peers_, [&](std::size_t e, std::span<Answer> answers) {
            ask_peer(peer_rays_[e], peer, call, answers, machine_.trace);
        });
    }

    /// By one pass each, and a second one of those that came near the best.
    [[nodiscard]] PeerCall fastest_call(const EmbreePeer& peer) const {
        const Pinned pinned(machine_.trace);
        const std::vector<PeerCall> calls = peer_calls(orders_of(rays_.rays));
        std::vector<double> times;
        for (const PeerCall& call : calls)
            times.push_back(time_of(peer, call));
        constexpr double near = 1.3;
        const double least = *std::min_element(times.begin(), times.end());
        for (std::size_t c = 0; c < calls.size(); ++c)
            if (times[c] <= near * least) times[c] = std::min(times[c], time_of(peer, calls[c]));
        return calls[static_cast<std::size_t>(
            std::min_element(times.begin(), times.end()) - times.begin()
        )];
    }

    [[nodiscard]] double time_of(const EmbreePeer& peer, const PeerCall& call) const {
        const Stopwatch wall;
        const ThreadStopwatch own;
        trace_peer(peer, call);
        return machine_.trace.threads() == 1 ? own.nanoseconds() : wall.nanoseconds();
    }

    // What the latest passes answered.

    [[nodiscard]] std::size_t wrong_answers() const {
        return count_wrong(
            std::span<const Answer>(right_.all()), std::span<const Answer>(ours_.all())
        );
    }

    [[nodiscard]] std::size_t wrong_peer_answers() const {
        std::size_t first = 0;
        std::size_t wrong = 0;
        for (const EmitterRays& of_emitter : rays_.emitters) {
            const std::span<const Ray> rays(of_emitter.rays);
            const std::span<const Answer> right = right_.all().subspan(first, rays.size());
            const std::span<const Answer> found = peers_.all().subspan(first, rays.size());
            if constexpr (std::is_same_v<Answer, bool>)
                wrong += count_wrong(right, found);
            else
                wrong += count_far_off(rays, right, found);
            first += rays.size();
        }
        return wrong;
    }

    [[nodiscard]] double hit_share() const {
        std::size_t hits = 0;
        for (const Answer& answer : right_.all())
            hits += is_hit(answer) ? 1U : 0U;
        return static_cast<double>(hits) /
               static_cast<double>(std::max<std::size_t>(1, rays_.count()));
    }

    /// "pencil_grid", or all that differ: "pencil_grid, none".
    [[nodiscard]] std::string structures() const {
        std::vector<std::string_view> kinds;
        for (const EmitterRays& of_emitter : rays_.emitters) {
            if (of_emitter.area.empty()) continue;
            const AreaId area = contest_.accelerator[of_emitter.area].id();
            const std::string_view kind = name_of(contest_.accelerator.local(area).choice.kind);
            if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
        }
        return kinds.empty() ? "whole accelerator" : fmt::format("{}", fmt::join(kinds, ", "));
    }

    /// Steps of every few rays, and their number.
    [[nodiscard]] std::size_t count_steps(CountedQuery& counts) const {
        constexpr std::size_t every = 8;
        std::size_t counted = 0;
        for (const EmitterRays& of_emitter : rays_.emitters) {
            with_structure(of_emitter, [&](const auto& structure) {
                for (std::size_t i = 0; i < of_emitter.rays.size(); i += every, ++counted) {
                    if constexpr (std::is_same_v<Answer, bool>)
                        static_cast<void>(structure.any_hit(of_emitter.rays[i], counts));
                    else
                        static_cast<void>(structure.closest_hit(of_emitter.rays[i], counts));
                }
            });
        }
        return counted;
    }

private:
    /// The handle of the emitter's area, or the whole accelerator for rays of no area.
    template <class Use>
    void with_structure(const EmitterRays& of_emitter, const Use& use) const {
        if (of_emitter.area.empty())
            use(contest_.accelerator);
        else
            use(contest_.accelerator[of_emitter.area]);
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

    const Contest& contest_;
    const ClassRays& rays_;
    const BenchMachine& machine_;
    std::vector<PeerRays> peer_rays_;
    Answers<Answer> ours_;
    Answers<Answer> peers_;
    Answers<Answer> right_;
};

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
    std::size_t check_oracle() const {
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

    BenchRow measure_single(BenchRow row) const {
        row.peer = Peer::single;
        const auto ours = [&] { race_.trace_singly(); };
        const auto peer = [&] { race_.trace_peer(contest_.peers.high, {}); };
        measure(row, ours, peer, {});
        if (row.count == 0) return row;
        if (effort_.is_thorough) {
            row.ratio_sorted = sorted_ratio();
            const auto robust = [&] { race_.trace_peer(*contest_.peers.robust, {}); };
            row.ratio_robust = timed(ours, robust).ratio;
        }
        if (kind_of(rays_.rays) == RayKind::general) return row;
        const auto searching = [&] { race_.trace_searching(); };
        searching();
        row.mismatches += race_.wrong_answers();
        row.searched_mrays =
            static_cast<double>(row.count) / timed(ours, searching).second_ns * 1e3;
        return row;
    }

    BenchRow measure_best(BenchRow row) const {
        row.peer = Peer::best;
        const PeerCall call = race_.fastest_call(contest_.peers.high);
        const auto ours = [&] { race_.trace_in_batches(); };
        const auto peer = [&] { race_.trace_peer(contest_.peers.high, call); };
        measure(row, ours, peer, call);
        if (row.count == 0 || !effort_.is_thorough) return row;
        const PeerCall robust_call = race_.fastest_call(*contest_.peers.robust);
        const auto robust = [&] { race_.trace_peer(*contest_.peers.robust, robust_call); };
        row.ratio_robust = timed(ours, robust).ratio;
        return row;
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
    [[nodiscard]] double sorted_ratio() const {
        const ClassRays in_order = sorted(rays_);
        const Race<Answer> race(contest_, in_order, machine_);
        return timed(
                   [&] { race.trace_singly(); }, [&] { race.trace_peer(contest_.peers.high, {}); }
        ).ratio;
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
