// Sorts a handful of primitives on all three axes at once, without a branch.
#pragma once

#include <raywise/build/binned_params.hpp>
#include <raywise/build/prim_box.hpp>
#include <raywise/build/quad.hpp>

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

namespace raywise {

/// The order of at most `few_prims` items by centroid, ties by place.
class FewRanks {
public:
    FewRanks(const PrimBox* items, std::size_t count) {
        assert(count <= few_prims);
        // An item's rank is the number of items before it.
        std::array<IntQuad, few_prims> ranks{};
        for (std::size_t i = 1; i < count; ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const IntQuad is_after = items[i].centroid() < items[j].centroid(); // -1 or 0
                ranks[j] -= is_after;
                ranks[i] += is_after + 1;
            }
        for (std::size_t i = 0; i < count; ++i)
            for (int axis = 0; axis < 3; ++axis)
                items_[place(axis, static_cast<std::size_t>(ranks[i][axis]))] =
                    static_cast<std::uint8_t>(i);
    }

    [[nodiscard]] std::size_t item(int axis, std::size_t rank) const {
        return items_[place(axis, rank)];
    }

private:
    [[nodiscard]] static std::size_t place(int axis, std::size_t rank) {
        return static_cast<std::size_t>(axis) * few_prims + rank;
    }

    std::array<std::uint8_t, 3 * few_prims> items_{};
};

} // namespace raywise
