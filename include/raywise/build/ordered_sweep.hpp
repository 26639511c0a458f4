// Every plane between neighboring centroids of one axis. After [MacDonald90].
#pragma once

#include <raywise/build/node_metric.hpp>
#include <raywise/build/prim_box.hpp>
#include <raywise/build/quad.hpp>
#include <raywise/build/split.hpp>

#include <algorithm>
#include <cstddef>

namespace raywise {

/// Offers `best` the planes of an axis. `item(rank)` are the items by ascending centroid on it;
/// `right_mass` is room for `count` numbers. Coinciding centroids are not separated.
template <class ItemAt, class Measure>
void sweep_ordered(
    std::size_t count,
    int axis,
    const ItemAt& item,
    const Measure& measure,
    float* right_mass,
    Split& best
) {
    const auto centroid = [&](std::size_t rank) {
        return item(rank).lo[axis] + item(rank).hi[axis];
    };
    QuadBox box;
    for (std::size_t rank = count - 1; rank > 0; --rank) {
        box.unite(item(rank).lo, item(rank).hi);
        right_mass[rank] = mass_of(measure, box);
    }
    box = {};
    for (std::size_t rank = 1; rank < count; ++rank) {
        box.unite(item(rank - 1).lo, item(rank - 1).hi);
        const float bound = centroid(rank);
        if (centroid(rank - 1) == bound) continue;
        const std::size_t right_count = count - rank;
        const float right = right_mass[rank];
        const double right_sum = static_cast<double>(right) * static_cast<double>(right_count);
        // The left half costs at least nothing, so it need not always be measured.
        if (right_sum > best.cost.sum) continue;
        const float left = mass_of(measure, box);
        const SplitCost cost{
            static_cast<double>(left) * static_cast<double>(rank) + right_sum,
            std::max(rank, right_count),
            left,
            right
        };
        if (!cost.is_better_than(best.cost)) continue;
        best.cost = cost;
        best.left_count = rank;
        best.is_left = {.axis = axis, .lo = 0, .scale = 1, .bound = bound};
    }
}

/// The boxes of both sides of the best split.
inline void bound_sides(const PrimBox* items, std::size_t count, Split& best) {
    for (std::size_t i = 0; i < count; ++i)
        (best.is_left(items[i]) ? best.left : best.right).unite(items[i].lo, items[i].hi);
}

} // namespace raywise
