// What tracing a set of rays costs, counted: unordered and unpruned as [Falcone24] counts, and
// ordered and pruned as renderers trace.
#pragma once

#include <raywise/analysis/statistics.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/closest_hit.hpp>
#include <raywise/trace/observer.hpp>
#include <raywise/trace/triangles.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace raywise {

/// Means per ray over all rays, those that miss the root included (they cost nothing).
struct MeanCounts {
    std::size_t rays = 0;
    std::size_t meeting = 0; ///< rays that open the root
    double cost = 0;         ///< in box tests
    double box_tests = 0;    ///< 1 + 2 per inner node that is opened
    double box_hits = 0;     ///< nodes that are opened: the thesis's "tests with nodes"
    double prim_tests = 0;

    /// Box hits and triangle tests, the thesis's "intersection tests".
    [[nodiscard]] double hits_per_ray() const { return box_hits + prim_tests; }
};

/// Means of counts, one element per ray.
[[nodiscard]] MeanCounts
mean_counts(std::span<const Counts> of_rays, const CostConstants& constants = {});

/// The unpruned counts of every ray; the same for any number of threads.
[[nodiscard]] std::vector<Counts> count_unpruned(
    const Bvh& tree,
    std::span<const Ray> rays,
    const Executor& executor = serial_executor()
);

/// Real cost: every box that the half-line meets is opened. For rays drawn from a distribution its
/// mean is the estimated cost under the distribution's own absolute measure.
[[nodiscard]] MeanCounts measure_real_cost(
    const Bvh& tree,
    std::span<const Ray> rays,
    const CostConstants& constants = {},
    const Executor& executor = serial_executor()
);

/// The counts of one traced ray, and what it hit.
struct TracedRay {
    std::optional<Hit> hit; ///< any hit: prim and t are not told, only that there is one
    Counts counts;
};

/// Traces every ray to its closest hit, near child first, pruned by the best hit so far.
template <TriangleSource Triangles>
[[nodiscard]] std::vector<TracedRay> trace_closest_counted(
    const Bvh& tree,
    const Triangles& triangles,
    std::span<const Ray> rays,
    const Executor& executor = serial_executor()
);

/// Traces every ray until some hit is found.
template <TriangleSource Triangles>
[[nodiscard]] std::vector<TracedRay> trace_any_counted(
    const Bvh& tree,
    const Triangles& triangles,
    std::span<const Ray> rays,
    const Executor& executor = serial_executor()
);

/// How the costs of traced rays spread.
struct OrderedCost {
    Summary box_tests;
    Summary node_visits;
    Summary prim_tests;
    Summary cost;
    double hit_fraction = 0;
};

[[nodiscard]] OrderedCost
summarize(std::span<const TracedRay> rays, const CostConstants& constants = {});

} // namespace raywise

#include <raywise/analysis/real_cost.inl.hpp> // IWYU pragma: export
