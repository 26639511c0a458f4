// Primitives counted and boxed by the part of the centroid bounds they fall in, on all three axes
// at once. After [Wald07].
#pragma once

#include <raywise/build/prim_box.hpp>
#include <raywise/build/quad.hpp>
#include <raywise/build/split.hpp>
#include <raywise/core/executor.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace raywise {

/// Cuts the centroid bounds of a node into equal bins on each axis.
class BinGrid {
public:
    static constexpr int most = 256; ///< bins per axis

    BinGrid() = default;

    BinGrid(const QuadBox& centroids, int bin_count);

    [[nodiscard]] int bin_count() const { return bin_count_; }

    /// False when the centroids coincide on the axis, or nearly so: their distances could not be
    /// divided by.
    [[nodiscard]] bool can_split(int axis) const { return scale_[axis] > 0; }

    /// min(bins - 1, floor(bins (c - lo) / (hi - lo))) in each lane; 0 where it cannot split.
    [[nodiscard]] IntQuad bins_of(Quad centroid) const {
        return __builtin_convertvector(min((centroid - lo_) * scale_, last_), IntQuad);
    }

    /// The bins below `plane`, in [1, bins - 1], on one axis.
    [[nodiscard]] Side below(int axis, int plane) const {
        // A bin is below a whole number exactly if the place it was rounded down from is.
        return {axis, lo_[axis], scale_[axis], static_cast<float>(plane)};
    }

private:
    Quad lo_{};
    Quad scale_{};
    Quad last_{};
    int bin_count_ = 0;
};

/// A count and a box per bin. Only as many as the grid has are ever touched.
class Bins {
public:
    explicit Bins(int bin_count);

    void add(const PrimBox* items, std::size_t count, const BinGrid& grid);
    void add(const Bins& other);

    [[nodiscard]] std::uint32_t count(int bin, int axis) const { return counts_[at(bin, axis)]; }

    /// Of an empty bin: the empty box.
    [[nodiscard]] const QuadBox& box(int bin, int axis) const { return boxes()[at(bin, axis)]; }

    /// Of the bins [begin, end).
    [[nodiscard]] QuadBox box(int begin, int end, int axis) const;

private:
    static constexpr std::size_t most = std::size_t{3} * BinGrid::most;

    [[nodiscard]] static std::size_t at(int bin, int axis) {
        return static_cast<std::size_t>(bin) * 3 + static_cast<std::size_t>(axis);
    }

    [[nodiscard]] QuadBox* boxes() { return reinterpret_cast<QuadBox*>(storage_.data()); }

    [[nodiscard]] const QuadBox* boxes() const {
        return reinterpret_cast<const QuadBox*>(storage_.data());
    }

    int bin_count_;
    std::array<std::uint32_t, most> counts_;
    alignas(32) std::array<std::byte, most * sizeof(QuadBox)> storage_;
};

/// The bins of a range; the same for any executor, since minima, maxima and counts do not depend on
/// the order.
void fill_bins(
    Bins& bins,
    const PrimBox* items,
    std::size_t count,
    const BinGrid& grid,
    const Executor& executor
);

} // namespace raywise
