#include <raywise/build/bins.hpp>

#include <raywise/build/prim_box.hpp>
#include <raywise/build/quad.hpp>
#include <raywise/build/split.hpp>
#include <raywise/core/executor.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>

namespace raywise {

BinGrid::BinGrid(const QuadBox& centroids, int bin_count)
    : lo_(centroids.lo)
    , scale_(make_quad(0))
    , last_(make_quad(static_cast<float>(bin_count - 1)))
    , bin_count_(bin_count) {
    // Below this the quotient would overflow.
    constexpr float least_extent = 0x1p-118F;
    const Quad extent = centroids.hi - centroids.lo;
    for (int axis = 0; axis < 3; ++axis)
        if (extent[axis] >= least_extent)
            scale_[axis] = static_cast<float>(bin_count) / extent[axis];
}

// NOLINTNEXTLINE(*-member-init): of the arrays, only what is used is written
Bins::Bins(int bin_count) : bin_count_(bin_count) {
    for (std::size_t i = 0; i < at(bin_count, 0); ++i) {
        counts_[i] = 0;
        std::construct_at(boxes() + i);
    }
}

void Bins::add(const PrimBox* items, std::size_t count, const BinGrid& grid) {
    // Copies, since the compiler cannot know that the bins do not overlap their owner or the grid.
    const BinGrid local = grid;
    QuadBox* boxes = this->boxes();
    std::uint32_t* counts = counts_.data();
    for (std::size_t i = 0; i < count; ++i) {
        const Quad lo = items[i].lo;
        const Quad hi = items[i].hi;
        const IntQuad bins = local.bins_of(lo + hi);
        for (int axis = 0; axis < 3; ++axis) {
            const std::size_t place = at(bins[axis], axis);
            ++counts[place];
            boxes[place].unite(lo, hi);
        }
    }
}

void Bins::add(const Bins& other) {
    for (std::size_t i = 0; i < at(bin_count_, 0); ++i) {
        counts_[i] += other.counts_[i];
        boxes()[i].unite(other.boxes()[i]);
    }
}

QuadBox Bins::box(int begin, int end, int axis) const {
    QuadBox result;
    for (int bin = begin; bin < end; ++bin)
        result.unite(box(bin, axis));
    return result;
}

void fill_bins(
    Bins& bins,
    const PrimBox* items,
    std::size_t count,
    const BinGrid& grid,
    const Executor& executor
) {
    if (executor.threads() == 1 || count < 2 * prim_chunk) {
        bins.add(items, count, grid);
        return;
    }
    std::mutex merging;
    executor.for_each_chunk(count, prim_chunk, [&](std::size_t begin, std::size_t end) {
        Bins part(grid.bin_count());
        part.add(items + begin, end - begin, grid);
        const std::scoped_lock lock(merging);
        bins.add(part);
    });
}

} // namespace raywise
