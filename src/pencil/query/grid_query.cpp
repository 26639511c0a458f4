// Queries of a pencil grid: compiled once for each instruction set.
#include "pencil/grid_data.hpp"
#include "pencil/kernels.hpp"
#include "pencil/query/counts.hpp"

#include <raywise/core/function_ref.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil.hpp>
#include <raywise/pencil/pencil_grid.hpp>
#include <raywise/pencil/pencil_grid_params.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
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
#include "pencil/query/single.inl.hpp"
#include "pencil/query/together.inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

template <Heading heading>
Verdict all_hits_along(const Grid& grid, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    Spot spot{};
    const Where where = locate<heading>(grid, segment_of(ray), spot);
    if (!is_valid(ray)) return Verdict::miss;
    if (where == Where::unknown) return Verdict::unknown;
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

template <Heading heading>
using Along = std::integral_constant<Heading, heading>;

/// Of rays toward the emitter.
HWY_INLINE Vec3 shadow_direction(const Grid& grid, const Vec3& origin) {
    return grid.pencil.kind() == Pencil::Kind::parallel ? -grid.pencil.direction()
                                                        : grid.pencil.apex() - origin;
}

/// `ask`, a function of an Along, for a ray of the pencil.
template <class Ask>
HWY_INLINE Verdict ask_along(const Grid& grid, const Ray& ray, const Ask& ask) {
    if (!(ray.t_min >= 0 && ray.t_min <= ray.t_max)) return Verdict::miss;
    const bool is_parallel = grid.pencil.kind() == Pencil::Kind::parallel;
    if (ray.direction == shadow_direction(grid, ray.origin) && (is_parallel || ray.t_max <= 1))
        return ask(Along<Heading::to_emitter>());
    if (is_parallel ? ray.direction == grid.pencil.direction() : ray.origin == grid.pencil.apex())
        return ask(Along<Heading::from_emitter>());
    return is_valid(ray) ? Verdict::unknown : Verdict::miss;
}

Verdict occluded(const Grid& grid, const Vec3& point, float t_min, PrimId excluded) {
    const auto ray = [=, at = &grid, from = &point] {
        return at->pencil.shadow_ray(*from, t_min, excluded);
    };
    return any_hit_along<Heading::to_emitter>(
        grid, {point, point, t_min, shadow_t_max(grid)}, ray, excluded, NoCounts{}
    );
}

template <class Count>
HWY_INLINE Verdict any_hit_of(const Grid& grid, const Ray& ray, Count count) {
    return ask_along(grid, ray, [&](auto along) HWY_ATTR {
        return any_hit_along<along>(grid, ray, count);
    });
}

Verdict any_hit(const Grid& grid, const Ray& ray) {
    return any_hit_of(grid, ray, NoCounts{});
}

Verdict any_hit_counted(const Grid& grid, const Ray& ray, PencilGridCounts& counts) {
    return any_hit_of(grid, ray, Counts{&counts});
}

template <class Count>
HWY_INLINE Verdict closest_hit_of(const Grid& grid, const Ray& ray, Hit& hit, Count count) {
    const Verdict verdict = ask_along(grid, ray, [&](auto along) HWY_ATTR {
        return closest_hit_along<along>(grid, ray, hit, count);
    });
    if (verdict == Verdict::miss) hit = Hit{};
    return verdict;
}

Verdict closest_hit(const Grid& grid, const Ray& ray, Hit& hit) {
    return closest_hit_of(grid, ray, hit, NoCounts{});
}

Verdict closest_hit_counted(const Grid& grid, const Ray& ray, Hit& hit, PencilGridCounts& counts) {
    return closest_hit_of(grid, ray, hit, Counts{&counts});
}

Verdict all_hits(const Grid& grid, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    return ask_along(grid, ray, [&](auto along) HWY_ATTR {
        return all_hits_along<along>(grid, ray, visit);
    });
}

HWY_INLINE void put(Together& rays, std::size_t i, Vec3 place, float t, PrimId excluded) {
    rays.x[i] = place.x;
    rays.y[i] = place.y;
    rays.z[i] = place.z;
    rays.t[i] = finite(t);
    rays.excluded[i] = excluded;
}

void occluded_batch(const Grid& grid, const PointBatch& batch, Verdict* verdicts) {
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

void any_hit_batch(const Grid& grid, const Ray* batch, std::size_t batch_size, Verdict* verdicts) {
    const float t_max = shadow_t_max(grid);
    Together rays{};
    for (std::size_t first = 0; first < batch_size; first += together) {
        const std::size_t count = std::min(together, batch_size - first);
        bool are_shadows = !grid.has_near;
        for (std::size_t i = 0; i < count; ++i) {
            const Ray& ray = batch[first + i];
            are_shadows &= ray.direction == shadow_direction(grid, ray.origin);
            are_shadows &= ray.t_min >= 0 && ray.t_min <= t_max && ray.t_max == t_max;
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

void closest_hit_batch(
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
            are_views &= ray.origin == grid.pencil.apex() && ray.t_min == 0 && ray.t_max >= 0;
            put(rays, i, ray.direction, ray.t_max, ray.excluded);
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
    occluded,
    any_hit,
    any_hit_counted,
    closest_hit,
    closest_hit_counted,
    all_hits,
    occluded_batch,
    any_hit_batch,
    closest_hit_batch
};

const Kernels* get_kernels() {
    return &kernels;
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace raywise::pencil_detail {

HWY_EXPORT(get_kernels);

namespace {

std::vector<const Kernels*> collect_kernels() {
    std::vector<const Kernels*> all;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        all.push_back(HWY_DYNAMIC_DISPATCH(get_kernels)());
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
