#include "analysis/comparison/ray_sets.hpp"
#include "analysis/comparison/tree_run.hpp"

#include <raywise/analysis/real_cost.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/toplevel/traced_tree.hpp>
#include <raywise/trace/brute_force.hpp>
#include <raywise/trace/observer.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace raywise::detail {

TreeRun run_tree(
    const BinaryTree& traced,
    const RaySets& sets,
    const CostConstants& constants,
    const Executor& executor
) {
    const auto& [tree, triangles] = traced;
    TreeRun run;
    for (const std::vector<Ray>& rays : sets) {
        const std::vector<Counts> unpruned = count_unpruned(tree, rays, executor);
        const MeanCounts real = mean_counts(unpruned, constants);
        run.real.push_back(real.cost);
        run.hits_per_ray.push_back(real.hits_per_ray());
        auto& every_real = run.every_real.emplace_back();
        for (const Counts& counts : unpruned)
            every_real.push_back(cost_of(counts, constants));

        const std::vector<TracedRay> closest =
            trace_closest_counted(tree, triangles, rays, executor);
        const OrderedCost ordered = summarize(closest, constants);
        run.box_tests.push_back(ordered.box_tests.mean);
        run.node_visits.push_back(ordered.node_visits.mean);
        run.prim_tests.push_back(ordered.prim_tests.mean);
        run.cost.push_back(ordered.cost.mean);
        auto& hits = run.hits.emplace_back();
        for (const TracedRay& ray : closest) {
            hits.push_back(ray.hit);
            run.every_cost.push_back(cost_of(ray.counts, constants));
        }
        run.any_cost.push_back(
            summarize(trace_any_counted(tree, triangles, rays, executor), constants).cost.mean
        );
    }
    return run;
}

BruteForceCheck check_by_brute_force(
    const TriangleView& triangles,
    const RaySets& sets,
    const HitSets& hits,
    double budget,
    const Executor& executor
) {
    const double affordable = budget / static_cast<double>(triangles.size());
    const std::size_t count =
        std::min(sets.front().size(), static_cast<std::size_t>(std::min(affordable, 1e9)));
    std::vector<std::uint8_t> differs(count, 0);
    executor.for_each_chunk(count, 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::optional<Hit> hit = brute_force_closest_hit(triangles, sets.front()[i]);
            differs[i] = is_same_hit(hit, hits.front()[i]) ? 0 : 1;
        }
    });
    BruteForceCheck check{.rays = count};
    for (const std::uint8_t differ : differs)
        check.wrong += differ;
    return check;
}

} // namespace raywise::detail
