// Takes subtrees out of a finished tree and puts them back where they cost least. After [Bittner13]
// and [Meister18]; ours: any hit measure, and moves that are carried out only when the cost of the
// whole tree, as it is by then, really falls.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/hit_measure.hpp>

namespace raywise {

/// Parameters of reinsert.
struct ReinsertionParams {
    double batch = 0.1;        ///< share of the nodes that every round looks at, the heaviest
                               ///< that are not known to stand well; in (0, 1]
    double least_gain = 0.003; ///< a round that lowers the summed mass of the inner nodes by a
                               ///< smaller share is the last; >= 0
    int max_rounds = 8;        ///< in [0, 1000]
};

/// Throws Error when a parameter is out of its range.
void check(const ReinsertionParams& params);

/// A tree over the same leaves, boxes and all, whose inner nodes have no more mass in total, and in
/// most cases much less: a traversal opens fewer of them. Leaves, which may list a primitive more
/// than once, are not taken apart. The depth stays at most Bvh::max_depth. `tree` must be valid;
/// inner boxes are tightened. About O(rounds x batch x nodes x log(nodes)) evaluations; the same
/// bytes for any executor. Throws Error when a parameter is out of its range.
template <HitMeasure M>
[[nodiscard]] Bvh reinsert(
    const Bvh& tree,
    const M& measure,
    const ReinsertionParams& params = {},
    const Executor& executor = serial_executor()
);

} // namespace raywise

#include <raywise/optimize/reinsertion.inl.hpp> // IWYU pragma: export
