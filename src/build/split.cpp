#include <raywise/build/split.hpp>

#include <raywise/build/prim_box.hpp>
#include <raywise/build/quad.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

namespace raywise {

namespace {

/// Unites what `bound` finds in the chunks of a range.
template <class Bound>
QuadBox bound_in_chunks(const PrimRange& range, const Executor& executor, const Bound& bound) {
    const PrimBox* items = range.from + range.first;
    QuadBox result;
    std::mutex merging;
    executor.for_each_chunk(range.count(), prim_chunk, [&](std::size_t begin, std::size_t end) {
        const QuadBox part = bound(items + begin, end - begin);
        const std::scoped_lock lock(merging);
        result.unite(part);
    });
    return result;
}

} // namespace

QuadBox bound_centroids(const PrimBox* items, std::size_t count) {
    // Two accumulators: a minimum waits for the one before it.
    QuadBox even;
    QuadBox odd;
    std::size_t i = 0;
    for (; i + 1 < count; i += 2) {
        even.unite(items[i].centroid());
        odd.unite(items[i + 1].centroid());
    }
    if (i < count) even.unite(items[i].centroid());
    even.unite(odd);
    return even;
}

QuadBox bound_boxes(const PrimRange& range, const Executor& executor) {
    return bound_in_chunks(range, executor, [](const PrimBox* items, std::size_t count) {
        QuadBox part;
        for (std::size_t i = 0; i < count; ++i)
            part.unite(items[i].lo, items[i].hi);
        return part;
    });
}

QuadBox bound_centroids(const PrimRange& range, const Executor& executor) {
    return bound_in_chunks(range, executor, [](const PrimBox* items, std::size_t count) {
        return bound_centroids(items, count);
    });
}

MedianSplit::MedianSplit(const PrimRange& range, std::size_t middle, int axis) : axis_(axis) {
    std::vector<std::pair<float, PrimId>> keys;
    keys.reserve(range.count());
    for (std::size_t i = range.first; i < range.last; ++i) {
        const PrimBox& item = range.from[i];
        keys.emplace_back(item.lo[axis] + item.hi[axis], item.id());
    }
    const auto nth = keys.begin() + static_cast<std::ptrdiff_t>(middle - range.first);
    std::nth_element(keys.begin(), nth, keys.end());
    centroid_ = nth->first;
    id_ = nth->second;
}

} // namespace raywise
