// The body of build_sweep.
#pragma once

#include <raywise/build/ordered_sweep.hpp>
#include <raywise/build/split.hpp>
#include <raywise/build/sweep.hpp>
#include <raywise/build/top_down.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace raywise {

/// Finds the cheapest plane between any two neighbors.
template <AxisPolicy P>
class SweepSearch {
public:
    explicit SweepSearch(const AxisFilter<P>& filter) : filter_(filter) {}

    template <class Measure>
    [[nodiscard]] std::optional<Split>
    operator()(const PrimRange& range, const Aabb& box, const Measure& measure, const Executor&)
        const {
        const PrimBox* items = range.from + range.first;
        std::vector<std::pair<float, std::size_t>> order(range.count());
        std::vector<float> right_mass(range.count());
        Split best;
        try_axes(filter_, box, best, [&](int axis) {
            for (std::size_t i = 0; i < order.size(); ++i)
                order[i] = {items[i].lo[axis] + items[i].hi[axis], i};
            std::sort(order.begin(), order.end());
            const auto item = [&](std::size_t rank) -> const PrimBox& {
                return items[order[rank].second];
            };
            sweep_ordered(range.count(), axis, item, measure, right_mass.data(), best);
        });
        if (best.left_count == 0) return std::nullopt;
        bound_sides(items, range.count(), best);
        return best;
    }

private:
    const AxisFilter<P>& filter_;
};

template <HitMeasure M, AxisPolicy P>
Bvh build_sweep(
    std::span<const Aabb> boxes,
    const M& measure,
    const BinnedParams& params,
    const Executor& executor,
    const AxisFilter<P>& filter
) {
    check(params);
    const SweepSearch<P> search(filter);
    return TopDown<M, SweepSearch<P>>(params, executor, search).build(boxes, measure);
}

} // namespace raywise
