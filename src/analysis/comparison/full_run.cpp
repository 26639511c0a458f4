#include "analysis/comparison/full_run.hpp"
#include "analysis/comparison/ray_sets.hpp"
#include "analysis/comparison/tree_run.hpp"

#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/served.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/observer.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace raywise::detail {

namespace {

void add_served(FullRun& run, const Served& served, bool hit, const CostConstants& constants) {
    bool local = false;
    for (const Search& search : served.searches()) {
        const double cost = cost_of(search.counts, constants);
        if (search.area) {
            local = true;
            run.local_cost += cost;
        } else if (local) {
            run.continuation_cost += cost;
        }
    }
    const Search* answer = served.answered();
    run.hits += hit ? 1U : 0U;
    run.searched += local ? 1U : 0U;
    run.answered += served.went_global() ? 0U : 1U;
    run.local_hits += answer != nullptr && answer->area ? 1U : 0U;
    if (local && served.went_global()) {
        ++run.continued;
        run.continued_hits += answer != nullptr && !answer->area ? 1U : 0U;
    }
}

/// One set of rays; `global_costs` and `global_hits` are those of the global tree alone.
FullRun run_full(
    const Accelerator& accelerator,
    std::span<const Ray> rays,
    std::span<const double> global_costs,
    std::span<const std::optional<Hit>> global_hits,
    const CostConstants& constants
) {
    FullRun run;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        Served served;
        const std::optional<Hit> hit = accelerator.closest_hit(rays[i], served);
        add_served(run, served, hit.has_value(), constants);
        run.cost += cost_of(served.total(), constants);
        if (!served.searches().empty() && served.searches().front().area) {
            run.global_alone_cost += global_costs[i];
        }
        run.wrong += is_same_hit(hit, global_hits[i]) ? 0U : 1U;
    }
    run.rays = rays.size();
    return run;
}

} // namespace

FullRun& FullRun::operator+=(const FullRun& other) {
    cost += other.cost;
    rays += other.rays;
    hits += other.hits;
    answered += other.answered;
    local_hits += other.local_hits;
    searched += other.searched;
    continued += other.continued;
    continued_hits += other.continued_hits;
    local_cost += other.local_cost;
    continuation_cost += other.continuation_cost;
    global_alone_cost += other.global_alone_cost;
    wrong += other.wrong;
    return *this;
}

std::vector<FullRun> run_full(
    const Accelerator& accelerator,
    const RaySets& sets,
    const TreeRun& global,
    const CostConstants& constants,
    const Executor& executor
) {
    std::vector<FullRun> runs(sets.size());
    executor.for_each_chunk(sets.size(), 1, [&](std::size_t s, std::size_t) {
        const std::size_t first = s * sets[s].size(); // sets are equally long
        runs[s] = run_full(
            accelerator,
            sets[s],
            std::span(global.every_cost).subspan(first, sets[s].size()),
            global.hits[s],
            constants
        );
    });
    return runs;
}

ShadowRun run_shadows(
    const Accelerator& accelerator,
    const RaySets& shadows,
    const CostConstants& constants,
    const Executor& executor
) {
    ShadowRun run{
        std::vector<double>(shadows.size()),
        std::vector<double>(shadows.size()),
        std::vector<std::uint64_t>(shadows.size())
    };
    executor.for_each_chunk(shadows.size(), 1, [&](std::size_t s, std::size_t) {
        CountedQuery full;
        Counts global;
        for (const Ray& ray : shadows[s]) {
            const bool here = accelerator.any_hit(ray, full);
            const auto& [tree, triangles] = *accelerator.global_tree().binary();
            const bool there = any_hit(tree, triangles, ray, global);
            run.wrong[s] += here == there ? 0U : 1U;
        }
        run.full[s] = cost_of(full, constants);
        run.global[s] = cost_of(global, constants);
    });
    return run;
}

} // namespace raywise::detail
