// Queries of a pencil grid: compiled once for each instruction set.
#include "pencil/grid_data.hpp"
#include "pencil/kernels.hpp"
#include "pencil/query/counts.hpp"
#include "pencil/query/sharp_filter.hpp"

#include <raywise/geometry/ray_triangle.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pencil/query/grid_query.cpp"
// The order matters: foreach_target.h includes this file anew for every target.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "pencil/query/locate.inl.hpp"
#include "pencil/query/list.inl.hpp"
#include "pencil/query/batch.inl.hpp"
#include "pencil/query/settle.inl.hpp"
#include "pencil/query/closest.inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float largest_float = std::numeric_limits<float>::max();

/// One of the triangles that the ray is not sure to hit, nor to miss.
template <class RayOf, class Count>
HWY_NOINLINE bool
is_hit_after_all(const Grid& grid, RayOf ray_of, Walk way, std::uint32_t bits, Count count) {
    const Ray ray = ray_of();
    for (; bits != 0; bits &= bits - 1)
        if (is_hit(grid, ray, way.id(bits), count)) return true;
    return false;
}

/// any_hit in a leaf's list. `ray()` is made only where the list leaves a doubt.
template <class RayOf, class Count>
HWY_INLINE Verdict look_through(
    const Grid& grid,
    RayOf ray,
    PrimId excluded,
    const Spot& spot,
    const Leaf& leaf,
    Count count
) {
    Walk way = walk(grid, leaf, spot);
    count.list(way.left);
    do {
        const Marks marks = way.marks();
        for (std::uint32_t sure = marks.sure; sure != 0; sure &= sure - 1)
            if (excluded == no_prim || way.id(sure) != excluded) return Verdict::hit;
        if (marks.possible != 0) [[unlikely]]
            if (is_hit_after_all(grid, ray, way, marks.possible, count)) return Verdict::hit;
    } while (way.advance());
    return is_complete(spot.deepest(), leaf) ? Verdict::miss : Verdict::unknown;
}

/// What is not in cells or too far away for them; nothing for all others.
template <class RayOf, class Count>
HWY_NOINLINE std::optional<Verdict>
any_hit_apart(const Grid& grid, RayOf ray, Where where, Count count) {
    if (where == Where::unknown) return is_valid(ray()) ? Verdict::unknown : Verdict::miss;
    const bool is_hit_near = std::any_of(grid.near.begin(), grid.near.end(), [&](PrimId id) {
        return is_hit(grid, ray(), id, count);
    });
    if (is_hit_near) return Verdict::hit;
    return std::nullopt;
}

template <Heading heading, class RayOf, class Count>
HWY_INLINE Verdict
any_hit_along(const Grid& grid, const Segment& segment, RayOf ray, PrimId excluded, Count count) {
    count.query();
    Spot spot{};
    const Where where = locate<heading>(grid, segment, spot);
    if (where == Where::unknown || grid.has_near) [[unlikely]]
        if (const auto verdict = any_hit_apart(grid, ray, where, count)) return *verdict;
    if (where == Where::outside) return Verdict::miss;
    const Leaf leaf = find_leaf<true>(grid, spot, count);
    if (leaf.has_verdict()) return static_cast<Verdict>(leaf.verdict);
    return look_through(grid, ray, excluded, spot, leaf, count);
}

template <Heading heading, class Count>
HWY_INLINE Verdict any_hit_along(const Grid& grid, const Ray& ray, Count count) {
    const auto itself = [at = &ray] { return *at; };
    return any_hit_along<heading>(grid, segment_of(ray), itself, ray.excluded, count);
}

template <Heading heading, class Count>
HWY_INLINE Verdict closest_hit_along(const Grid& grid, const Ray& ray, Hit& hit, Count count) {
    count.query();
    Spot spot{};
    const Where where = locate<heading>(grid, segment_of(ray), spot);
    if (where == Where::unknown) [[unlikely]]
        return is_valid(ray) ? Verdict::unknown : Verdict::miss;
    Closest<heading, Count> closest(grid, ray, count);
    for (const PrimId id : grid.near)
        closest.add(id);
    if (where == Where::inside) {
        const Leaf leaf = find_leaf<false>(grid, spot, count);
        if (!leaf.has_verdict()) {
            Walk way = walk(grid, leaf, spot);
            count.list(way.left);
            do
                closest.look(way);
            while (way.advance());
            if (!is_complete(way.deepest(spot), leaf)) return Verdict::unknown;
        }
    }
    return closest.finish(hit) ? Verdict::hit : Verdict::miss;
}

template <Heading heading>
Verdict all_hits_along(const Grid& grid, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    Spot spot{};
    const Where where = locate<heading>(grid, segment_of(ray), spot);
    if (where == Where::unknown) return is_valid(ray) ? Verdict::unknown : Verdict::miss;
    bool found = false;
    const auto add = [&](PrimId id) HWY_ATTR {
        if (id == ray.excluded) return;
        if (const auto hit = decide(grid, ray, id, ray.t_max)) {
            found = true;
            visit(*hit);
        }
    };
    for (const PrimId id : grid.near)
        add(id);
    if (where == Where::inside) {
        const Leaf leaf = find_leaf<false>(grid, spot, NoCounts{});
        if (!leaf.has_verdict()) {
            Walk way = walk(grid, leaf, spot);
            do
                for (std::uint32_t bits = way.marks().possible; bits != 0; bits &= bits - 1)
                    if (const PrimId id = way.id(bits);
                        std::find(grid.near.begin(), grid.near.end(), id) == grid.near.end())
                        add(id);
            while (way.advance());
            if (!is_complete(spot.deepest(), leaf)) return Verdict::unknown;
        }
    }
    return found ? Verdict::hit : Verdict::miss;
}

/// Of the pencil's shadow rays.
HWY_INLINE float shadow_t_max(const Grid& grid) {
    return grid.pencil.kind() == Pencil::Kind::parallel ? std::numeric_limits<float>::infinity()
                                                        : 1.0F;
}

HWY_INLINE Heading heading_of(const Grid& grid, const Ray& ray) {
    const bool is_away = grid.pencil.kind() == Pencil::Kind::parallel
                             ? ray.direction == grid.pencil.direction()
                             : ray.origin == grid.pencil.apex();
    return is_away ? Heading::from_emitter : Heading::to_emitter;
}

Verdict Occluded(const Grid& grid, const Vec3& point, float t_min, PrimId excluded) {
    const auto ray = [=, at = &grid, from = &point] {
        return at->pencil.shadow_ray(*from, t_min, excluded);
    };
    return any_hit_along<Heading::to_emitter>(
        grid, {point, point, t_min, shadow_t_max(grid)}, ray, excluded, NoCounts{}
    );
}

template <class Count>
HWY_INLINE Verdict any_hit_of(const Grid& grid, const Ray& ray, Count count) {
    return heading_of(grid, ray) == Heading::to_emitter
               ? any_hit_along<Heading::to_emitter>(grid, ray, count)
               : any_hit_along<Heading::from_emitter>(grid, ray, count);
}

Verdict AnyHit(const Grid& grid, const Ray& ray) {
    return any_hit_of(grid, ray, NoCounts{});
}

Verdict AnyHitCounted(const Grid& grid, const Ray& ray, PencilGridCounts& counts) {
    return any_hit_of(grid, ray, Counts{&counts});
}

template <class Count>
HWY_INLINE Verdict closest_hit_of(const Grid& grid, const Ray& ray, Hit& hit, Count count) {
    return heading_of(grid, ray) == Heading::to_emitter
               ? closest_hit_along<Heading::to_emitter>(grid, ray, hit, count)
               : closest_hit_along<Heading::from_emitter>(grid, ray, hit, count);
}

Verdict ClosestHit(const Grid& grid, const Ray& ray, Hit& hit) {
    return closest_hit_of(grid, ray, hit, NoCounts{});
}

Verdict ClosestHitCounted(const Grid& grid, const Ray& ray, Hit& hit, PencilGridCounts& counts) {
    return closest_hit_of(grid, ray, hit, Counts{&counts});
}

Verdict AllHits(const Grid& grid, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    return heading_of(grid, ray) == Heading::to_emitter
               ? all_hits_along<Heading::to_emitter>(grid, ray, visit)
               : all_hits_along<Heading::from_emitter>(grid, ray, visit);
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
    std::array<Leaf, together> leaves;
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
        prefetch_list(grid, leaves[i]);
        open[kept] = static_cast<std::uint8_t>(i);
        kept += static_cast<std::size_t>(!leaves[i].has_verdict());
    }
    for (std::size_t k = 0; k < kept; ++k) {
        const std::size_t i = open[k];
        const auto ray = [&ray_of, i] { return ray_of(i); };
        verdicts[i] =
            look_through(grid, ray, rays.excluded[i], rays.spot(i), leaves[i], NoCounts{});
    }
}

HWY_INLINE void put(Together& rays, std::size_t i, Vec3 place, float t, PrimId excluded) {
    rays.x[i] = place.x;
    rays.y[i] = place.y;
    rays.z[i] = place.z;
    rays.t[i] = t;
    rays.excluded[i] = excluded;
}

void OccludedBatch(const Grid& grid, const PointBatch& batch, Verdict* verdicts) {
    const auto excluded = [&](std::size_t i) {
        return batch.excluded == nullptr ? no_prim : batch.excluded[i];
    };
    Together rays{};
    for (std::size_t first = 0; first < batch.count; first += together) {
        const std::size_t count = std::min(together, batch.count - first);
        const auto ray_of = [&, first](std::size_t i) {
            return grid.pencil.shadow_ray(
                batch.points[first + i], batch.t_min, excluded(first + i)
            );
        };
        if (grid.has_near) {
            for (std::size_t i = 0; i < count; ++i)
                verdicts[first + i] =
                    any_hit_along<Heading::to_emitter>(grid, ray_of(i), NoCounts{});
            continue;
        }
        for (std::size_t i = 0; i < count; ++i)
            put(rays, i, batch.points[first + i], batch.t_min, excluded(first + i));
        any_hit_together(grid, count, rays, ray_of, verdicts + first);
    }
}

void AnyHitBatch(const Grid& grid, const Ray* batch, std::size_t batch_size, Verdict* verdicts) {
    const bool is_parallel = grid.pencil.kind() == Pencil::Kind::parallel;
    const float t_max = shadow_t_max(grid);
    Together rays{};
    for (std::size_t first = 0; first < batch_size; first += together) {
        const std::size_t count = std::min(together, batch_size - first);
        bool are_shadows = !grid.has_near;
        for (std::size_t i = 0; i < count; ++i) {
            const Ray& ray = batch[first + i];
            are_shadows &= ray.t_max == t_max;
            // A shadow ray toward a lamp has any direction but starts elsewhere.
            are_shadows &= is_parallel ? ray.direction == -grid.pencil.direction()
                                       : ray.origin != grid.pencil.apex();
            put(rays, i, ray.origin, ray.t_min, ray.excluded);
        }
        const auto ray_of = [at = batch + first](std::size_t i) { return at[i]; };
        if (are_shadows) {
            any_hit_together(grid, count, rays, ray_of, verdicts + first);
            continue;
        }
        for (std::size_t i = 0; i < count; ++i)
            verdicts[first + i] = any_hit_of(grid, batch[first + i], NoCounts{});
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
    std::array<Leaf, together> leaves;
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
        prefetch_list(grid, leaves[i]);
        open[kept] = static_cast<std::uint8_t>(i);
        kept += static_cast<std::size_t>(!leaves[i].has_verdict());
    }
    std::size_t surely = 0;
    for (std::size_t k = 0; k < kept; ++k) {
        const std::size_t i = open[k];
        const Spot spot = rays.spot(i);
        Closest<heading, NoCounts> closest(grid, batch[i], NoCounts{});
        Walk way = walk(grid, leaves[i], spot);
        do
            closest.look(way);
        while (way.advance());
        prims[i] = closest.only_one();
        sure[surely] = static_cast<std::uint8_t>(i);
        if (!is_complete(way.deepest(spot), leaves[i]))
            verdicts[i] = Verdict::unknown;
        else if (prims[i] != no_prim)
            ++surely;
        else if (closest.finish(hits[i]))
            verdicts[i] = Verdict::hit;
    }
    settle_together(grid, batch, std::span(sure).first(surely), prims, hits, verdicts);
}

void ClosestHitBatch(
    const Grid& grid,
    const Ray* batch,
    std::size_t batch_size,
    Hit* hits,
    Verdict* verdicts
) {
    Together rays{};
    const bool is_radial = grid.pencil.kind() == Pencil::Kind::radial;
    for (std::size_t first = 0; first < batch_size; first += together) {
        const std::size_t count = std::min(together, batch_size - first);
        bool are_views = is_radial && !grid.has_near;
        for (std::size_t i = 0; i < count; ++i) {
            const Ray& ray = batch[first + i];
            are_views &= ray.origin == grid.pencil.apex() && ray.t_min == 0;
            put(rays, i, ray.direction, std::min(ray.t_max, largest_float), ray.excluded);
        }
        if (are_views) {
            closest_hit_together(grid, batch + first, count, rays, hits + first, verdicts + first);
            continue;
        }
        for (std::size_t i = first; i < first + count; ++i)
            verdicts[i] = closest_hit_of(grid, batch[i], hits[i], NoCounts{});
    }
}

const Kernels kernels{
    hwy::TargetName(HWY_TARGET),
    Occluded,
    AnyHit,
    AnyHitCounted,
    ClosestHit,
    ClosestHitCounted,
    AllHits,
    OccludedBatch,
    AnyHitBatch,
    ClosestHitBatch
};

const Kernels* GetKernels() {
    return &kernels;
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace raywise::pencil_detail {

HWY_EXPORT(GetKernels);

namespace {

std::vector<const Kernels*> collect_kernels() {
    std::vector<const Kernels*> all;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        all.push_back(HWY_DYNAMIC_DISPATCH(GetKernels)());
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return all;
}

} // namespace

std::span<const Kernels* const> all_kernels() {
    static const std::vector<const Kernels*> all = collect_kernels();
    return all;
}

const Kernels& best_kernels() {
    return *all_kernels().front();
}

std::optional<Hit> decide(const Grid& grid, const Ray& ray, PrimId id, float t_max) {
    return ExactKernel::decide(ray, grid.triangles[id], id, t_max);
}

} // namespace raywise::pencil_detail

#endif
