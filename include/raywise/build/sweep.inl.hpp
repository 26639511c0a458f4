// The body of build_sweep.
#pragma once

#include <raywise/build/split.hpp>
#include <raywise/build/sweep.hpp>
#include <raywise/build/top_down.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace raywise {

/// The doubled centroids below `bound` against the rest.
struct SweepSplit {
    SplitCost cost;
    int axis = 0;
    float bound = 0;
    std::size_t left_count = 0;
    QuadBox left;
    QuadBox right;

    [[nodiscard]] bool operator()(const PrimBox& item) const {
        return item.lo[axis] + item.hi[axis] < bound;
    }

    [[nodiscard]] Aabb left_box() const { return to_aabb(left); }

    [[nodiscard]] Aabb right_box() const { return to_aabb(right); }
};

/// Finds the cheapest plane between any two neighbors.
template <AxisPolicy P>
class SweepSearch {
public:
    explicit SweepSearch(const AxisFilter<P>& filter) : filter_(filter) {}

    template <class Measure>
    [[nodiscard]] std::optional<SweepSplit>
    operator()(const SearchNode& node, const Measure& metric, const Executor& executor) const {
        static_cast<void>(executor);
        SweepSplit best;
        Scratch scratch(node.count);
        const std::array<bool, 3> is_wanted = wanted_axes(filter_, node.box);
        // Axes that the filter skips are tried when the others cannot split.
        for (const bool pass : {true, false}) {
            for (int axis = 0; axis < 3; ++axis)
                if (is_wanted[static_cast<std::size_t>(axis)] == pass)
                    sweep(node, axis, metric, scratch, best);
            if (best.left_count > 0) break;
        }
        if (best.left_count == 0) return std::nullopt;
        for (std::size_t i = 0; i < node.count; ++i)
            (best(node.items[i]) ? best.left : best.right)
                .unite(node.items[i].lo, node.items[i].hi);
        return best;
    }

private:
    struct Scratch {
        explicit Scratch(std::size_t count) : order(count), right_mass(count) {}

        std::vector<std::pair<float, std::size_t>> order; ///< doubled centroid, item
        std::vector<float> right_mass;                    ///< of the items from this rank on
    };

    template <class Measure>
    static void sweep(
        const SearchNode& node,
        int axis,
        const Measure& metric,
        Scratch& scratch,
        SweepSplit& best
    ) {
        auto& order = scratch.order;
        for (std::size_t i = 0; i < node.count; ++i)
            order[i] = {node.items[i].lo[axis] + node.items[i].hi[axis], i};
        std::sort(order.begin(), order.end());
        const auto unite_ranked = [&](QuadBox& box, std::size_t rank) {
            const PrimBox& item = node.items[order[rank].second];
            box.unite(item.lo, item.hi);
        };

        QuadBox box;
        for (std::size_t rank = node.count - 1; rank > 0; --rank) {
            unite_ranked(box, rank);
            scratch.right_mass[rank] = static_cast<float>(metric(to_aabb(box)));
        }
        box = {};
        for (std::size_t rank = 1; rank < node.count; ++rank) {
            unite_ranked(box, rank - 1);
            if (order[rank - 1].first == order[rank].first) continue;
            const std::size_t right_count = node.count - rank;
            const float right = scratch.right_mass[rank];
            const auto left = static_cast<float>(metric(to_aabb(box)));
            const SplitCost cost{
                static_cast<double>(left) * static_cast<double>(rank) +
                    static_cast<double>(right) * static_cast<double>(right_count),
                std::max(rank, right_count),
                left,
                right
            };
            if (!cost.is_better_than(best.cost)) continue;
            best.cost = cost;
            best.axis = axis;
            best.bound = order[rank].first;
            best.left_count = rank;
        }
    }

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
