// The body of build_binned.
#pragma once

#include <raywise/build/binned.hpp>
#include <raywise/build/bins.hpp>
#include <raywise/build/few_ranks.hpp>
#include <raywise/build/ordered_sweep.hpp>
#include <raywise/build/split.hpp>
#include <raywise/build/top_down.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace raywise {

/// Finds the cheapest plane between bins, or between any two of few primitives.
template <AxisPolicy P>
class BinnedSearch {
public:
    BinnedSearch(const BinnedParams& params, const AxisFilter<P>& filter)
        : bin_count_(params.bin_count), filter_(filter) {}

    template <class Measure>
    [[nodiscard]] std::optional<Split> operator()(
        const PrimRange& range,
        const Aabb& box,
        const Measure& measure,
        const Executor& executor
    ) const {
        const PrimBox* items = range.from + range.first;
        if (range.count() <= few_prims) return sweep_few(items, range.count(), box, measure);

        const BinGrid grid(range.centroids, bins_for(range.count(), bin_count_));
        Bins bins(grid.bin_count());
        fill_bins(bins, items, range.count(), grid, executor);
        Split best;
        int plane = 0;
        try_axes(filter_, box, best, [&](int axis) {
            if (grid.can_split(axis))
                sweep_bins(bins, grid, range.count(), axis, measure, best, plane);
        });
        if (best.left_count == 0) return std::nullopt;
        best.left = bins.box(0, plane, best.is_left.axis);
        best.right = bins.box(plane, grid.bin_count(), best.is_left.axis);
        return best;
    }

private:
    /// Tries the planes between the bins of one axis. An empty bin brings no new plane.
    template <class Measure>
    static void sweep_bins(
        const Bins& bins,
        const BinGrid& grid,
        std::size_t count,
        int axis,
        const Measure& measure,
        Split& best,
        int& best_plane
    ) {
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written before it is read.
        std::array<float, BinGrid::most> right_mass;
        QuadBox box;
        for (int bin = grid.bin_count() - 1; bin > 0; --bin) {
            if (bins.count(bin, axis) == 0) continue;
            box.unite(bins.box(bin, axis));
            right_mass[static_cast<std::size_t>(bin)] = mass_of(measure, box);
        }
        box = {};
        std::size_t left_count = 0;
        for (int bin = 0; left_count < count; ++bin) {
            const std::size_t in_bin = bins.count(bin, axis);
            if (in_bin == 0) continue;
            if (left_count > 0) {
                const std::size_t right_count = count - left_count;
                const float right = right_mass[static_cast<std::size_t>(bin)];
                const double right_sum =
                    static_cast<double>(right) * static_cast<double>(right_count);
                // The left half costs at least nothing, so it need not always be measured.
                if (right_sum <= best.cost.sum) {
                    const float left = mass_of(measure, box);
                    const SplitCost cost{
                        static_cast<double>(left) * static_cast<double>(left_count) + right_sum,
                        std::max(left_count, right_count),
                        left,
                        right
                    };
                    if (cost.is_better_than(best.cost)) {
                        best.cost = cost;
                        best.left_count = left_count;
                        best.is_left = grid.below(axis, bin);
                        best_plane = bin;
                    }
                }
            }
            box.unite(bins.box(bin, axis));
            left_count += in_bin;
        }
    }

    template <class Measure>
    [[nodiscard]] std::optional<Split>
    sweep_few(const PrimBox* items, std::size_t count, const Aabb& box, const Measure& measure)
        const {
        const FewRanks order(items, count);
        std::array<float, few_prims> right_mass{};
        Split best;
        try_axes(filter_, box, best, [&](int axis) {
            const auto item = [&](std::size_t rank) -> const PrimBox& {
                return items[order.item(axis, rank)];
            };
            sweep_ordered(count, axis, item, measure, right_mass.data(), best);
        });
        if (best.left_count == 0) return std::nullopt;
        bound_sides(items, count, best);
        return best;
    }

    int bin_count_;
    const AxisFilter<P>& filter_;
};

template <HitMeasure M, AxisPolicy P>
Bvh build_binned(
    std::span<const Aabb> boxes,
    const M& measure,
    const BinnedParams& params,
    const Executor& executor,
    const AxisFilter<P>& filter
) {
    check(params);
    const BinnedSearch<P> search(params, filter);
    return TopDown<M, BinnedSearch<P>>(params, executor, search).build(boxes, measure);
}

} // namespace raywise
