// Queries of a few rays at once: while one waits for memory, the others go on. Included once for
// every instruction set.
#if defined(RAYWISE_PENCIL_QUERY_TOGETHER) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_QUERY_TOGETHER
#undef RAYWISE_PENCIL_QUERY_TOGETHER
#else
#define RAYWISE_PENCIL_QUERY_TOGETHER
#endif

#include "pencil/query/batch.inl.hpp"
#include "pencil/query/closest.inl.hpp"
#include "pencil/query/settle.inl.hpp"
#include "pencil/query/single.inl.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// So many lists are asked for before they are read: more would not fit what the processor keeps in
/// flight.
constexpr std::size_t ahead = 4;

/// Of the pencil's shadow rays.
HWY_INLINE float shadow_t_max(const Grid& grid) {
    return grid.pencil.kind() == Pencil::Kind::parallel ? std::numeric_limits<float>::infinity()
                                                        : 1.0F;
}

/// any_hit for the first shadow rays of `rays`, which pass all geometry; `ray_of(i)` is one of
/// them.
template <class RayOf>
HWY_INLINE void any_hit_together(
    const Grid& grid,
    std::size_t count,
    Together& rays,
    const RayOf& ray_of,
    Verdict* verdicts
) {
    std::array<Leaf, together> leaves; // NOLINT(*-member-init): written before they are read
    std::array<std::uint8_t, together> open{};
    locate_shadows(grid, count, shadow_t_max(grid), rays);
    std::size_t left = 0;
    for (std::size_t i = 0; i < count; ++i) {
        verdicts[i] = Verdict::miss;
        if (rays.where[i] != Where::inside) [[unlikely]] {
            if (rays.where[i] == Where::unknown && is_valid(ray_of(i)))
                verdicts[i] = Verdict::unknown;
            continue;
        }
        open[left++] = static_cast<std::uint8_t>(i);
        hwy::Prefetch(top_cell(rays.spot(i)));
    }
    // Branches that no predictor guesses become steps of this counter.
    std::size_t kept = 0;
    for (std::size_t k = 0; k < left; ++k) {
        const std::size_t i = open[k];
        leaves[i] = find_leaf<true>(grid, rays.spot(i), NoCounts{});
        verdicts[i] = static_cast<Verdict>(leaves[i].verdict);
        open[kept] = static_cast<std::uint8_t>(i);
        kept += static_cast<std::size_t>(!leaves[i].has_verdict());
    }
    for (std::size_t k = 0; k < std::min(kept, ahead); ++k)
        prefetch_list(grid, leaves[open[k]]);
    for (std::size_t k = 0; k < kept; ++k) {
        if (k + ahead < kept) prefetch_list(grid, leaves[open[k + ahead]]);
        const std::size_t i = open[k];
        const auto ray = [&ray_of, i] { return ray_of(i); };
        verdicts[i] =
            look_through(grid, ray, rays.excluded[i], rays.spot(i), leaves[i], NoCounts{});
    }
}

/// Hits of rays that surely pass through their triangles; those that cannot be settled are decided.
/// `order` names `count` of the rays.
HWY_INLINE void settle_together(
    const Grid& grid,
    const Ray* batch,
    std::span<const std::uint8_t> order,
    const std::array<PrimId, together>& prims,
    Hit* hits,
    Verdict* verdicts
) {
    using D = hn::CappedTag<double, 8>;
    const D d;
    const hn::Rebind<float, D> floats;
    constexpr std::size_t most = 8;
    alignas(64) std::array<std::array<float, most>, 12> rows{};
    for (std::size_t first = 0; first < order.size(); first += hn::Lanes(d)) {
        const std::size_t lanes = std::min(order.size() - first, hn::Lanes(d));
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const std::size_t i = order[first + lane];
            const Triangle triangle = grid.triangles[prims[i]];
            const std::array<Vec3, 4> points{
                triangle.v0, triangle.v1, triangle.v2, batch[i].direction
            };
            for (std::size_t k = 0; k < points.size(); ++k) {
                rows[3 * k][lane] = points[k].x;
                rows[3 * k + 1][lane] = points[k].y;
                rows[3 * k + 2][lane] = points[k].z;
            }
        }
        const auto load = [&](std::size_t row) HWY_ATTR {
            return hn::PromoteTo(d, hn::Load(floats, rows[row].data()));
        };
        const auto point = [&](std::size_t k) HWY_ATTR {
            return Points<D>{load(3 * k), load(3 * k + 1), load(3 * k + 2)};
        };
        const Points<D> origin{
            hn::Set(d, grid.apex.x), hn::Set(d, grid.apex.y), hn::Set(d, grid.apex.z)
        };
        const Settled<D> settled = settle(d, origin, point(3), point(0), point(1), point(2));
        alignas(64) std::array<float, most> t, u, v;          // NOLINT(*-member-init)
        alignas(64) std::array<double, most> sum, is_settled; // NOLINT(*-member-init)
        hn::Store(settled.t, floats, t.data());
        hn::Store(settled.u, floats, u.data());
        hn::Store(settled.v, floats, v.data());
        hn::Store(settled.sum, d, sum.data());
        hn::Store(settled.is_settled, d, is_settled.data());
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const std::size_t i = order[first + lane];
            verdicts[i] = Verdict::hit;
            if (is_settled[lane] == 1)
                hits[i] = {t[lane], u[lane], v[lane], prims[i], sum[lane] < 0};
            else if (const auto hit = decide(grid, batch[i], prims[i], batch[i].t_max))
                hits[i] = *hit;
        }
    }
}

/// closest_hit for rays from the apex, which begin before all geometry.
HWY_INLINE void closest_hit_together(
    const Grid& grid,
    const Ray* batch,
    std::size_t count,
    Together& rays,
    Hit* hits,
    Verdict* verdicts
) {
    constexpr auto heading = Heading::from_emitter;
    std::array<Leaf, together> leaves; // NOLINT(*-member-init): written before they are read
    std::array<std::uint8_t, together> open{}, sure{};
    std::array<PrimId, together> prims{};
    locate_from_apex(grid, count, rays);
    std::size_t left = 0;
    for (std::size_t i = 0; i < count; ++i) {
        verdicts[i] = Verdict::miss;
        if (rays.where[i] == Where::inside) {
            open[left++] = static_cast<std::uint8_t>(i);
            hwy::Prefetch(top_cell(rays.spot(i)));
        } else if (rays.where[i] == Where::unknown) {
            verdicts[i] = closest_hit_along<heading>(grid, batch[i], hits[i], NoCounts{});
        }
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < left; ++k) {
        const std::size_t i = open[k];
        leaves[i] = find_leaf<false>(grid, rays.spot(i), NoCounts{});
        open[kept] = static_cast<std::uint8_t>(i);
        kept += static_cast<std::size_t>(!leaves[i].has_verdict());
    }
    for (std::size_t k = 0; k < std::min(kept, ahead); ++k)
        prefetch_list(grid, leaves[open[k]]);
    std::size_t surely = 0;
    for (std::size_t k = 0; k < kept; ++k) {
        if (k + ahead < kept) prefetch_list(grid, leaves[open[k + ahead]]);
        const std::size_t i = open[k];
        const Spot spot = rays.spot(i);
        Closest<heading, NoCounts> closest(grid, batch[i], hits[i], NoCounts{});
        Walk way = walk(grid, leaves[i], spot);
        do
            closest.look(way);
        while (way.advance());
        prims[i] = closest.only_one();
        sure[surely] = static_cast<std::uint8_t>(i);
        if (!is_complete(way.probe.deepest, leaves[i])) {
            const bool is_first =
                closest.finish() && is_listed<heading>(grid, batch[i], hits[i], leaves[i]);
            verdicts[i] = is_first ? Verdict::hit : Verdict::unknown;
        } else if (prims[i] != no_prim) {
            ++surely;
        } else if (closest.finish()) {
            verdicts[i] = Verdict::hit;
        }
    }
    settle_together(grid, batch, std::span(sure).first(surely), prims, hits, verdicts);
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
