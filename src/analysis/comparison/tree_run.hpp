// Sets of rays through one tree.
#pragma once

#include "analysis/comparison/ray_sets.hpp"

#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/toplevel/traced_tree.hpp>

#include <cstdint>
#include <vector>

namespace raywise::detail {

/// What one tree answers and what it costs; means are of each set.
struct TreeRun {
    std::vector<double> real, hits_per_ray, box_tests, node_visits, prim_tests, cost, any_cost;
    std::vector<double> every_cost;              ///< ordered, of each ray of all sets
    std::vector<std::vector<double>> every_real; ///< by set, of each ray
    HitSets hits;
};

[[nodiscard]] TreeRun run_tree(
    const BinaryTree& traced,
    const RaySets& sets,
    const CostConstants& constants,
    const Executor& executor
);

/// Rays that were traced by brute force, and how many of them hit something else than found.
struct BruteForceCheck {
    std::uint64_t rays = 0;
    std::uint64_t wrong = 0;
};

/// Checks rays of the first set within a budget of triangle tests.
[[nodiscard]] BruteForceCheck check_by_brute_force(
    const TriangleView& triangles,
    const RaySets& sets,
    const HitSets& hits,
    double budget,
    const Executor& executor
);

} // namespace raywise::detail
