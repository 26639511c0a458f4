#include <raywise/analysis/real_cost.hpp>

#include <raywise/analysis/statistics.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/count_unpruned.hpp>
#include <raywise/trace/observer.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace raywise {

namespace {

template <class Value>
Summary summarize_each(std::span<const TracedRay> rays, Value&& value) {
    std::vector<double> values;
    values.reserve(rays.size());
    for (const TracedRay& ray : rays)
        values.push_back(static_cast<double>(value(ray.counts)));
    return summarize(values);
}

} // namespace

MeanCounts mean_counts(std::span<const Counts> of_rays, const CostConstants& constants) {
    MeanCounts mean{.rays = of_rays.size()};
    if (of_rays.empty()) return mean;
    Counts sum;
    for (const Counts& counts : of_rays) {
        sum += counts;
        if (counts.node_visits() > 0) ++mean.meeting;
    }
    const double unit = 1 / static_cast<double>(of_rays.size());
    mean.cost = unit * cost_of(sum, constants);
    mean.box_tests = unit * static_cast<double>(sum.boxes);
    mean.box_hits = unit * static_cast<double>(sum.node_visits());
    mean.prim_tests = unit * static_cast<double>(sum.prims);
    return mean;
}

std::vector<Counts>
count_unpruned(const Bvh& tree, std::span<const Ray> rays, const Executor& executor) {
    constexpr std::size_t chunk = 256;
    std::vector<Counts> counts(rays.size());
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            counts[i] = count_unpruned(tree, rays[i]);
    });
    return counts;
}

MeanCounts measure_real_cost(
    const Bvh& tree,
    std::span<const Ray> rays,
    const CostConstants& constants,
    const Executor& executor
) {
    return mean_counts(count_unpruned(tree, rays, executor), constants);
}

OrderedCost summarize(std::span<const TracedRay> rays, const CostConstants& constants) {
    OrderedCost cost;
    if (rays.empty()) return cost;
    cost.box_tests = summarize_each(rays, [](const Counts& c) { return c.boxes; });
    cost.node_visits = summarize_each(rays, [](const Counts& c) { return c.node_visits(); });
    cost.prim_tests = summarize_each(rays, [](const Counts& c) { return c.prims; });
    cost.cost = summarize_each(rays, [&](const Counts& c) { return cost_of(c, constants); });
    std::size_t hits = 0;
    for (const TracedRay& ray : rays)
        hits += ray.hit ? 1U : 0U;
    cost.hit_fraction = static_cast<double>(hits) / static_cast<double>(rays.size());
    return cost;
}

} // namespace raywise
