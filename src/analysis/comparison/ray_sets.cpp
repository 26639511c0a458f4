#include "analysis/comparison/ray_sets.hpp"

#include <raywise/analysis/comparison.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/geometry/ray.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace raywise::detail {

RaySets draw_rays(
    const Distribution& distribution,
    std::size_t index,
    const CompareParams& params,
    const Executor& executor
) {
    RaySets sets(static_cast<std::size_t>(params.seeds));
    for (std::size_t s = 0; s < sets.size(); ++s) {
        const std::uint64_t seed = mix_bits(params.seed + s) + index;
        sets[s].resize(params.rays);
        executor.for_each_chunk(params.rays, 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                Rng rng(seed, i);
                sets[s][i] = sample(distribution, rng);
            }
        });
    }
    return sets;
}

RaySets shadow_rays(const RaySets& sets, const HitSets& hits) {
    RaySets shadows(sets.size());
    for (std::size_t s = 0; s < sets.size(); ++s) {
        for (std::size_t i = 0; i < sets[s].size(); ++i) {
            const std::optional<Hit>& hit = hits[s][i];
            if (!hit) continue;
            shadows[s].push_back(
                {.origin = point_at(sets[s][i], hit->t),
                 .direction = -sets[s][i].direction,
                 .t_min = 0,
                 .t_max = hit->t,
                 .excluded = hit->prim}
            );
        }
    }
    return shadows;
}

bool is_same_hit(const std::optional<Hit>& a, const std::optional<Hit>& b) {
    if (a.has_value() != b.has_value()) return false;
    return !a || (a->t == b->t && a->prim == b->prim);
}

std::uint64_t count_differences(const HitSets& a, const HitSets& b) {
    std::uint64_t wrong = 0;
    for (std::size_t s = 0; s < a.size(); ++s) {
        for (std::size_t i = 0; i < a[s].size(); ++i)
            wrong += is_same_hit(a[s][i], b[s][i]) ? 0U : 1U;
    }
    return wrong;
}

} // namespace raywise::detail
