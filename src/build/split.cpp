#include <raywise/build/split.hpp>

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

namespace raywise {

QuadBox bound_boxes(const PrimRange& range, const Executor& executor) {
    const PrimBox* items = range.from + range.first;
    QuadBox result;
    std::mutex merging;
    executor.for_each_chunk(range.count(), prim_chunk, [&](std::size_t begin, std::size_t end) {
        QuadBox part;
        for (std::size_t i = begin; i < end; ++i)
            part.unite(items[i].lo, items[i].hi);
        const std::scoped_lock lock(merging);
        result.unite(part);
    });
    return result;
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
