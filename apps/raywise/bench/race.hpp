// The rays of one class, ready to be traced by ours, by Embree and by the oracle.
#pragma once

#include "bench/class_bench.hpp"
#include "bench/pinned.hpp"

#include <raywise/analysis/answer_check.hpp>
#include <raywise/analysis/ray_order.hpp>
#include <raywise/analysis/stopwatch.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace raywise::app {

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

inline bool is_hit(bool answer) {
    return answer;
}

inline bool is_hit(const Hit& answer) {
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

inline void ask_peer(
    const PeerRays& rays,
    const EmbreePeer& peer,
    const PeerCall& call,
    std::span<bool> answers,
    const Executor& executor
) {
    rays.occluded(peer, call, answers, executor);
}

inline void ask_peer(
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
inline std::vector<RayOrder> orders_of(RayClass rays) {
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
            ask_all(contest.oracle, rays.emitters[e].rays, answers, machine.build);
        });
    }

    // What can be timed.

    void trace_singly(const Accelerator& accelerator) const {
        for_each_emitter(ours_, [&](std::size_t e, std::span<Answer> answers) {
            with_structure(accelerator, rays_.emitters[e], [&](const auto& structure) {
                ask_singly(structure, rays_.emitters[e].rays, answers, machine_.trace);
            });
        });
    }

    void trace_in_batches(const Accelerator& accelerator) const {
        for_each_emitter(ours_, [&](std::size_t e, std::span<Answer> answers) {
            with_structure(accelerator, rays_.emitters[e], [&](const auto& structure) {
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
        times.reserve(calls.size());
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

    [[nodiscard]] std::size_t wrong_peer_answers() const { return rounded_wrong(peers_); }

    /// Of ours in the fast mode, which rounds t as the peer does.
    [[nodiscard]] std::size_t wrong_fast_answers() const { return rounded_wrong(ours_); }

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
            with_structure(contest_.accelerator, of_emitter, [&](const auto& structure) {
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
    void
    with_structure(const Accelerator& accelerator, const EmitterRays& of_emitter, const Use& use)
        const {
        if (of_emitter.area.empty())
            use(accelerator);
        else
            use(accelerator[of_emitter.area]);
    }

    /// Answers that are wrong by more than roundings of t.
    [[nodiscard]] std::size_t rounded_wrong(const Answers<Answer>& answers) const {
        std::size_t first = 0;
        std::size_t wrong = 0;
        for (const EmitterRays& of_emitter : rays_.emitters) {
            const std::span<const Ray> rays(of_emitter.rays);
            const std::span<const Answer> right = right_.all().subspan(first, rays.size());
            const std::span<const Answer> found = answers.all().subspan(first, rays.size());
            if constexpr (std::is_same_v<Answer, bool>)
                wrong += count_wrong(right, found);
            else
                wrong += count_far_off(rays, right, found);
            first += rays.size();
        }
        return wrong;
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

} // namespace raywise::app
