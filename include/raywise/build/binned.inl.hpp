// The body of build_binned.
#pragma once

#include <raywise/build/binned.hpp>
#include <raywise/build/bins.hpp>
#include <raywise/build/split.hpp>
#include <raywise/build/top_down.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

namespace raywise {

/// The bins below `plane` against the rest.
struct BinnedSplit {
    SplitCost cost;
    BinGrid grid;
    int axis = 0;
    int plane = 0;
    std::size_t left_count = 0;
    QuadBox left;
    QuadBox right;

    [[nodiscard]] bool operator()(const PrimBox& item) const {
        return grid.bin_of(item, axis) < plane;
    }

    [[nodiscard]] Aabb left_box() const { return to_aabb(left); }

    [[nodiscard]] Aabb right_box() const { return to_aabb(right); }
};

/// Finds the cheapest plane between bins.
template <AxisPolicy P>
class BinnedSearch {
public:
    BinnedSearch(const BinnedParams& params, const AxisFilter<P>& filter)
        : bin_count_(params.bin_count), filter_(filter) {}

    template <class Measure>
    [[nodiscard]] std::optional<BinnedSplit>
    operator()(const SearchNode& node, const Measure& metric, const Executor& executor) const {
        const BinGrid grid(node.centroids, bins_for(node.count, bin_count_));
        Bins bins(grid.bin_count());
        fill_bins(bins, node.items, node.count, grid, executor);

        BinnedSplit best;
        best.grid = grid;
        const std::array<bool, 3> is_wanted = wanted_axes(filter_, node.box);
        // Axes that the filter skips are tried when the others cannot split.
        for (const bool pass : {true, false}) {
            for (int axis = 0; axis < 3; ++axis)
                if (is_wanted[static_cast<std::size_t>(axis)] == pass && grid.can_split(axis))
                    sweep(bins, node.count, axis, metric, best);
            if (best.left_count > 0) break;
        }
        if (best.left_count == 0) return std::nullopt;
        best.left = bins.box(0, best.plane, best.axis);
        best.right = bins.box(best.plane, grid.bin_count(), best.axis);
        return best;
    }

private:
    /// Tries the planes of one axis. An empty bin brings no new plane.
    template <class Measure>
    static void
    sweep(const Bins& bins, std::size_t count, int axis, const Measure& metric, BinnedSplit& best) {
        const int bin_count = best.grid.bin_count();
        std::array<float, BinGrid::most> right_mass;
        QuadBox box;
        for (int bin = bin_count - 1; bin > 0; --bin) {
            if (bins.count(bin, axis) == 0) continue;
            box.unite(bins.box(bin, axis));
            right_mass[static_cast<std::size_t>(bin)] = static_cast<float>(metric(to_aabb(box)));
        }
        box = {};
        std::size_t left_count = 0;
        for (int bin = 0; bin < bin_count; ++bin) {
            const std::size_t in_bin = bins.count(bin, axis);
            if (in_bin == 0) continue;
            if (left_count > 0) {
                const std::size_t right_count = count - left_count;
                const float right = right_mass[static_cast<std::size_t>(bin)];
                const double right_sum =
                    static_cast<double>(right) * static_cast<double>(right_count);
                // The left half costs at least nothing, so it need not always be measured.
                if (right_sum <= best.cost.sum) {
                    const auto left = static_cast<float>(metric(to_aabb(box)));
                    const SplitCost cost{
                        static_cast<double>(left) * static_cast<double>(left_count) + right_sum,
                        std::max(left_count, right_count),
                        left,
                        right
                    };
                    if (cost.is_better_than(best.cost)) {
                        best.cost = cost;
                        best.axis = axis;
                        best.plane = bin;
                        best.left_count = left_count;
                    }
                }
            }
            box.unite(bins.box(bin, axis));
            left_count += in_bin;
        }
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
