// A triangle drawn over a run of slots: lanes answer "surely missed", or "surely hit, at a depth
// surely inside"; the rest is decided exactly. Included once for every instruction set.
#if defined(RAYWISE_PENCIL_INVERSION_DRAW_RUN) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_INVERSION_DRAW_RUN
#undef RAYWISE_PENCIL_INVERSION_DRAW_RUN
#else
#define RAYWISE_PENCIL_INVERSION_DRAW_RUN
#endif

#include "pencil/inversion/aim.inl.hpp"
#include "pencil/inversion/answers.hpp"
#include "pencil/inversion/edges.hpp"
#include "pencil/inversion/plane_depth.inl.hpp"
#include "pencil/inversion/raster.hpp"
#include "pencil/inversion/ray_tiles.hpp"

#include <raywise/geometry/ray_triangle.hpp>

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();

namespace raywise::detail::HWY_NAMESPACE {

template <class Work>
HWY_INLINE void for_lanes(Mask mask, const Work& work) {
    const D d;
    if (hn::AllFalse(d, mask)) return;
    std::array<std::uint8_t, 8> bytes{};
    hn::StoreMaskBits(d, mask, bytes.data());
    auto bits = std::bit_cast<std::uint64_t>(bytes);
    for (; bits != 0; bits &= bits - 1)
        work(static_cast<std::size_t>(std::countr_zero(bits)));
}

/// The function of edge i at the points (u, v).
HWY_INLINE V edge_function(const Edges& edges, std::size_t i, V u, V v) {
    const D d;
    return hn::MulAdd(
        hn::Set(d, edges.u[i]), u, hn::MulAdd(hn::Set(d, edges.v[i]), v, hn::Set(d, edges.k[i]))
    );
}

/// Keeps in `possible` what may pass between the edges. Returns what surely does.
HWY_INLINE Mask pass_edges(const Edges& edges, V e0, V e1, V e2, Mask& possible) {
    const D d;
    const V bar = hn::Set(d, edges.sure);
    const V lowest = hn::Min(e0, hn::Min(e1, e2));
    if (edges.one_sided) {
        possible = hn::And(possible, hn::Ge(lowest, hn::Zero(d)));
        return hn::Gt(lowest, bar);
    }
    const V highest = hn::Max(e0, hn::Max(e1, e2));
    const Mask missed = hn::And(hn::Gt(highest, bar), hn::Lt(lowest, hn::Neg(bar)));
    possible = hn::AndNot(missed, possible);
    return hn::MaskFromVec(hn::Zero(d));
}

/// The roundings of depths as seen and as the exact kernel answers; `start` is that at depth 0.
HWY_INLINE V margin_at(V depth, V start) {
    return hn::MulAdd(hn::Set(D(), 16 * unit_roundoff), hn::Abs(depth), start);
}

/// Whether depths from `least` on are surely in an interval that begins at `near`.
HWY_INLINE Mask is_surely_after(V near, V least, V start) {
    const Mask is_open = hn::Eq(near, hn::Set(D(), -infinity));
    return hn::Or(is_open, hn::Ge(least, hn::Add(near, margin_at(near, start))));
}

/// Whether depths up to `most` are surely in an interval that ends at `far`.
HWY_INLINE Mask is_surely_before(V far, V most, V start) {
    const Mask is_open = hn::Eq(far, hn::Set(D(), infinity));
    return hn::Or(is_open, hn::Le(most, hn::Sub(far, margin_at(far, start))));
}

/// One triangle over the slots of one tile; `is_closest`: nearer hits replace what slots have.
template <bool is_radial, bool is_closest>
class RunDrawing {
public:
    RunDrawing(const Raster& raster, const Shot& shot, bool is_reversed)
        : raster_(raster)
        , tiles_(raster.tiles)
        , t_(*shot.drawn)
        , edges_(shot.edges)
        , face_(raster.tiles.faces[shot.face])
        , tile_(*shot.tile)
        , is_reversed_(is_reversed) {}

    /// Asks the rays of the slots [first, last), and maybe some after them.
    void operator()(std::uint32_t first, std::uint32_t last) const {
        const D d;
        const DU du;
        const V depth_lo = hn::Set(d, edges_.depth_lo);
        const V depth_hi = hn::Set(d, edges_.depth_hi);
        for (std::size_t slot = first; slot < last; slot += hn::Lanes(d)) {
            const V near = hn::LoadU(d, &tiles_.near[slot]);
            const V far = hn::LoadU(d, &tiles_.far[slot]);
            Mask possible = hn::And(hn::Ge(far, depth_lo), hn::Le(near, depth_hi));
            if (hn::AllFalse(d, possible)) continue;
            const V u = hn::LoadU(d, &tiles_.u[slot]);
            const V v = hn::LoadU(d, &tiles_.v[slot]);
            const V e0 = edge_function(edges_, 0, u, v);
            const V e1 = edge_function(edges_, 1, u, v);
            const V e2 = edge_function(edges_, 2, u, v);
            const Mask sure = pass_edges(edges_, e0, e1, e2, possible);
            if (hn::AllFalse(d, possible)) continue;
            const auto ids = hn::Set(du, static_cast<std::uint32_t>(t_.id));
            const auto excluded = hn::Eq(hn::LoadU(du, &tiles_.excluded[slot]), ids);
            possible = hn::AndNot(hn::RebindMask(d, excluded), possible);
            if constexpr (is_closest)
                keep_closer(slot, near, far, e0, e1, e2, possible, sure);
            else
                keep_hits(slot, near, far, e0, e1, e2, possible, sure);
        }
    }

private:
    using DU = hn::RebindToUnsigned<D>;

    HWY_INLINE void
    keep_closer(std::size_t slot, V near, V far, V e0, V e1, V e2, Mask possible, Mask sure) const {
        const D d;
        const DU du;
        const V start = hn::Set(d, 16 * unit_roundoff * tile_.scale);
        V least = hn::Set(d, edges_.depth_lo);
        V most = hn::Set(d, edges_.depth_hi);
        if (edges_.has_plane)
            plane_depth<is_radial>(t_, edges_, is_reversed_, e0, e1, e2, least, most);
        possible = hn::And(possible, hn::And(hn::Le(least, far), hn::Ge(most, near)));
        if (hn::AllFalse(d, possible)) return;
        const V after = hn::Add(most, margin_at(most, start));
        const V before = hn::Sub(least, margin_at(least, start));
        const V limit = hn::LoadU(d, &tiles_.least[slot]);
        sure = hn::And(hn::And(sure, possible), hn::Le(after, limit));
        sure = hn::And(sure, is_surely_after(near, least, start));
        if (!hn::AllFalse(d, sure)) {
            const auto ids = hn::Set(du, static_cast<std::uint32_t>(t_.id));
            hn::BlendedStore(after, sure, d, &tiles_.far[slot]);
            hn::BlendedStore(before, sure, d, &tiles_.least[slot]);
            hn::BlendedStore(ids, hn::RebindMask(du, sure), du, &tiles_.best[slot]);
        }
        for_lanes(hn::AndNot(sure, possible), [&](std::size_t lane) HWY_ATTR {
            resolve(raster_, face_, slot + lane, t_.id);
        });
    }

    HWY_INLINE void
    keep_hits(std::size_t slot, V near, V far, V e0, V e1, V e2, Mask possible, Mask sure) const {
        const D d;
        const V start = hn::Set(d, 16 * unit_roundoff * tile_.scale);
        V least = hn::Set(d, edges_.depth_lo);
        V most = hn::Set(d, edges_.depth_hi);
        const auto inside = [&]() HWY_ATTR {
            return hn::And(is_surely_after(near, least, start), is_surely_before(far, most, start));
        };
        sure = hn::And(sure, possible);
        const Mask in = inside();
        if (edges_.has_plane && !hn::AllFalse(d, hn::AndNot(in, possible))) {
            plane_depth<is_radial>(t_, edges_, is_reversed_, e0, e1, e2, least, most);
            possible = hn::And(possible, hn::And(hn::Le(least, far), hn::Ge(most, near)));
            sure = hn::And(hn::And(sure, possible), hn::Or(in, inside()));
        } else {
            sure = hn::And(sure, in);
        }
        for_lanes(sure, [&](std::size_t lane) HWY_ATTR { set_hit(raster_, tile_, slot + lane); });
        for_lanes(hn::AndNot(sure, possible), [&](std::size_t lane) HWY_ATTR {
            const Ray& ray = raster_.rays[tiles_.index[slot + lane]];
            if (ExactKernel::decide(ray, raster_.triangles[t_.id], t_.id, ray.t_max))
                set_hit(raster_, tile_, slot + lane);
        });
    }

    const Raster& raster_;
    RayTiles& tiles_;
    const Drawn& t_;
    const Edges& edges_;
    const Face& face_;
    Tile& tile_;
    bool is_reversed_;
};

} // namespace raywise::detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
