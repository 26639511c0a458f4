// Queries of one ray. Included once for every instruction set.
#if defined(RAYWISE_PENCIL_QUERY_SINGLE) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_QUERY_SINGLE
#undef RAYWISE_PENCIL_QUERY_SINGLE
#else
#define RAYWISE_PENCIL_QUERY_SINGLE
#endif

#include "pencil/query/closest.inl.hpp"
#include "pencil/query/counts.hpp"
#include "pencil/query/list.inl.hpp"
#include "pencil/query/locate.inl.hpp"

#include <raywise/geometry/ray.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

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
    if (!is_valid(ray())) return Verdict::miss;
    if (where == Where::unknown) return Verdict::unknown;
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

/// Whether the leaf's list has all that a ray from the emitter meets before the hit.
template <Heading heading>
HWY_NOINLINE bool is_listed(const Grid& grid, const Ray& ray, const Hit& hit, const Leaf& leaf) {
    if (heading == Heading::to_emitter) return false;
    Spot spot{};
    const Segment until{ray.origin, ray.direction, ray.t_min, hit.t};
    return locate<heading>(grid, until, spot) == Where::inside && is_complete(spot.deepest(), leaf);
}

template <Heading heading, class Count>
HWY_INLINE Verdict closest_hit_along(const Grid& grid, const Ray& ray, Hit& hit, Count count) {
    count.query();
    Spot spot{};
    const Where where = locate<heading>(grid, segment_of(ray), spot);
    if (where == Where::unknown || grid.has_near) [[unlikely]]
        if (!is_valid(ray)) return Verdict::miss;
    if (where == Where::unknown) [[unlikely]]
        return Verdict::unknown;
    Closest<heading, Count> closest(grid, ray, hit, count);
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
            if (!is_complete(way.probe.deepest, leaf)) {
                const bool is_first = closest.finish() && is_listed<heading>(grid, ray, hit, leaf);
                return is_first ? Verdict::hit : Verdict::unknown;
            }
        }
    }
    return closest.finish() ? Verdict::hit : Verdict::miss;
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
