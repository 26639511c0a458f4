// The closest hit among references of a list. Included once for every instruction set.
#if defined(RAYWISE_PENCIL_QUERY_CLOSEST) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_QUERY_CLOSEST
#undef RAYWISE_PENCIL_QUERY_CLOSEST
#else
#define RAYWISE_PENCIL_QUERY_CLOSEST
#endif

#include "pencil/query/list.inl.hpp"
#include "pencil/query/locate.inl.hpp"
#include "pencil/query/settle.inl.hpp"
#include "pencil/query/sharp_filter.hpp"

#include <raywise/geometry/ray_triangle.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

/// For one triangle, by double arithmetic where that is sure, exact otherwise.
template <class Count>
HWY_INLINE bool is_hit(const Grid& grid, const Ray& ray, PrimId id, Count count) {
    if (id == ray.excluded) return false;
    count.prim();
    if (grid.is_tame)
        if (const auto hit = sharp_hit(ray, grid.triangles[id])) return *hit;
    count.decided();
    return decide(grid, ray, id, ray.t_max).has_value();
}

/// The closest hit so far. A reference that is surely met, and before all others, waits: its t is
/// computed only when no closer one is found. The hit is written in place: copies of what was just
/// written stall.
template <Heading heading, class Count>
class Closest {
public:
    Closest(const Grid& grid, const Ray& ray, Hit& best, Count count)
        : grid_(grid), ray_(ray), best_(best), count_(count) {
        best_ = Hit{};
        best_.t = ray.t_max;
    }

    /// The chunk that `way` is at; brings its probe nearer.
    HWY_INLINE void look(Walk& way) {
        Depths depths; // NOLINT(*-member-init): written next
        const Marks marks = way.marks(depths);
        for (std::uint32_t bits = marks.possible; bits != 0; bits &= bits - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(bits));
            if (depths.least[i] > way.probe.deepest) continue;
            const PrimId id = way.id(bits);
            if (id == ray_.excluded) continue;
            // Seen from the other side, depths order the other way around.
            if constexpr (heading == Heading::to_emitter) {
                add(id);
                continue;
            }
            if ((marks.sure & bits & (0U - bits)) != 0) {
                // Else it is nearer than the one that waits, which is forgotten.
                if (depths.greatest[i] >= waiting_least_) decide_waiting();
                waiting_ = id;
                waiting_least_ = depths.least[i];
            } else if (!add(id)) {
                continue;
            }
            way.probe.deepest = std::min(way.probe.deepest, depths.greatest[i]);
        }
    }

    /// Whether it is hit before the best so far.
    bool add(PrimId id) {
        if (id == ray_.excluded || id == best_.prim) return false;
        count_.prim();
        count_.decided();
        const auto hit = decide(grid_, ray_, id, best_.t);
        if (!hit || !(best_.prim == no_prim || is_closer(*hit, best_))) return false;
        best_ = *hit;
        return true;
    }

    /// The only triangle that may be hit first, when that is known; else no_prim.
    [[nodiscard]] PrimId only_one() const { return best_.prim == no_prim ? waiting_ : no_prim; }

    /// Whether there is one; else the hit is Hit{}.
    [[nodiscard]] HWY_INLINE bool finish() {
        decide_waiting();
        if (best_.prim == no_prim) best_ = Hit{};
        return best_.prim != no_prim;
    }

private:
    /// It is hit, and within the ray's interval.
    HWY_INLINE void decide_waiting() {
        if (waiting_ == no_prim) return;
        const PrimId id = std::exchange(waiting_, no_prim);
        const Triangle triangle = grid_.triangles[id];
        count_.prim();
        count_.decided();
        if (best_.prim == no_prim) {
            if (settle(ray_, triangle, id, best_)) [[likely]]
                return;
            best_ = Hit{};
            best_.t = ray_.t_max;
        }
        const auto hit = decide(grid_, ray_, id, best_.t);
        if (hit && (best_.prim == no_prim || is_closer(*hit, best_))) best_ = *hit;
    }

    const Grid& grid_;
    const Ray& ray_;
    Hit& best_;
    Count count_;
    PrimId waiting_ = no_prim;
    std::int32_t waiting_least_ = 0;
};

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
