// A way to divide a node, how candidates are compared, and the stable partition that carries one
// out.
#pragma once

#include <raywise/build/prim_box.hpp>
#include <raywise/core/executor.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <mutex>
#include <vector>

namespace raywise {

/// A candidate's price and balance.
struct SplitCost {
    double sum = std::numeric_limits<double>::infinity(); ///< m(L) n_L + m(R) n_R
    std::size_t larger = 0;                               ///< primitives of the larger child
    float left_mass = 0;
    float right_mass = 0;

    /// Ties go to the more balanced. Between equals the one found first stays, so candidates come
    /// in the order axis, plane.
    [[nodiscard]] bool is_better_than(const SplitCost& other) const {
        return sum < other.sum || (sum == other.sum && larger < other.larger);
    }
};

/// The left side of a plane: (c - lo) scale < bound for a doubled centroid c on the axis. With lo 0
/// and scale 1 the bound is a doubled centroid itself.
struct Side {
    int axis = 0;
    float lo = 0;
    float scale = 1;
    float bound = 0;

    [[nodiscard]] bool operator()(const PrimBox& item) const {
        return (item.lo[axis] + item.hi[axis] - lo) * scale < bound;
    }
};

/// The best split of a node.
struct Split {
    SplitCost cost;
    std::size_t left_count = 0; ///< 0: none was found
    Side is_left;
    QuadBox left;
    QuadBox right;
};

/// Primitives on the way from one array to the other: [first, last) of `from` goes to the same
/// slots of `to`.
struct PrimRange {
    PrimBox* from = nullptr;
    PrimBox* to = nullptr;
    std::size_t first = 0;
    std::size_t last = 0;
    QuadBox centroids{}; ///< bounds of the doubled centroids

    [[nodiscard]] std::size_t count() const { return last - first; }

    /// A part of what has arrived.
    [[nodiscard]] PrimRange
    arrived(std::size_t begin, std::size_t end, const QuadBox& its_centroids) const {
        return {to, from, begin, end, its_centroids};
    }
};

/// Most primitives that halving can bring into leaves of at most `leaf_size` in `levels` levels;
/// beyond 2^31 of no interest.
[[nodiscard]] constexpr std::size_t capacity(std::size_t leaf_size, int levels) {
    return leaf_size << static_cast<unsigned>(std::min(levels, 31));
}

/// Ranges of at least two chunks are worked on in chunks.
inline constexpr std::size_t prim_chunk = 1U << 14U;

/// Bounds of the doubled centroids of two halves.
struct CentroidBounds {
    QuadBox left;
    QuadBox right;

    void unite(const CentroidBounds& other) {
        left.unite(other.left);
        right.unite(other.right);
    }
};

/// Bounds of the doubled centroids.
[[nodiscard]] QuadBox bound_centroids(const PrimBox* items, std::size_t count);

/// Moves `count` items to `left` and `right` on; the next free places stand there afterwards.
template <class IsLeft>
CentroidBounds scatter(
    const PrimBox* from,
    std::size_t count,
    PrimBox* to,
    std::size_t left,
    std::size_t right,
    const IsLeft& is_left
) {
    // Copied, since the compiler cannot know that the target does not overlap it.
    const IsLeft goes_left = is_left;
    CentroidBounds bounds;
    // In blocks, so that bounding the centroids finds them in the nearest cache.
    constexpr std::size_t block = 256;
    for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t end = std::min(begin + block, count);
        const std::size_t left_begin = left;
        const std::size_t right_begin = right;
        for (std::size_t i = begin; i < end; ++i) {
            // No branch: which side is next cannot be predicted.
            const bool is_on_left = goes_left(from[i]);
            to[is_on_left ? left : right] = from[i];
            left += is_on_left ? 1 : 0;
            right += is_on_left ? 0 : 1;
        }
        bounds.left.unite(bound_centroids(to + left_begin, left - left_begin));
        bounds.right.unite(bound_centroids(to + right_begin, right - right_begin));
    }
    return bounds;
}

/// Moves the primitives for which `is_left` holds to [first, middle) and the rest behind, both in
/// their old order; `middle` must fit. Returns the bounds of both halves' doubled centroids. The
/// same result for any executor.
template <class IsLeft>
CentroidBounds partition_stable(
    const PrimRange& range,
    std::size_t middle,
    const IsLeft& is_left,
    const Executor& executor
) {
    const PrimBox* from = range.from + range.first;
    const std::size_t count = range.count();
    if (executor.threads() == 1 || count < 2 * prim_chunk)
        return scatter(from, count, range.to, range.first, middle, is_left);

    std::vector<std::size_t> left_before((count + prim_chunk - 1) / prim_chunk + 1, 0);
    executor.for_each_chunk(count, prim_chunk, [&](std::size_t begin, std::size_t end) {
        std::size_t left = 0;
        for (std::size_t i = begin; i < end; ++i)
            left += is_left(from[i]) ? std::size_t{1} : std::size_t{0};
        left_before[begin / prim_chunk + 1] = left;
    });
    for (std::size_t c = 1; c < left_before.size(); ++c)
        left_before[c] += left_before[c - 1];

    CentroidBounds bounds;
    std::mutex merging;
    executor.for_each_chunk(count, prim_chunk, [&](std::size_t begin, std::size_t end) {
        const std::size_t left = left_before[begin / prim_chunk];
        const CentroidBounds part = scatter(
            from + begin,
            end - begin,
            range.to,
            range.first + left,
            middle + (begin - left),
            is_left
        );
        const std::scoped_lock lock(merging);
        bounds.unite(part);
    });
    return bounds;
}

/// The box around the primitives that a range comes with; the same for any executor.
[[nodiscard]] QuadBox bound_boxes(const PrimRange& range, const Executor& executor);

/// Bounds of their doubled centroids; the same for any executor.
[[nodiscard]] QuadBox bound_centroids(const PrimRange& range, const Executor& executor);

/// Divides a range so that the `middle - first` primitives of the least (centroid on `axis`, id) go
/// left: the median split, which separates even what coincides.
class MedianSplit {
public:
    MedianSplit(const PrimRange& range, std::size_t middle, int axis);

    [[nodiscard]] bool operator()(const PrimBox& item) const {
        const float c = item.lo[axis_] + item.hi[axis_];
        return c < centroid_ || (c == centroid_ && item.id() < id_);
    }

private:
    int axis_;
    float centroid_ = 0; ///< of the first primitive that goes right
    PrimId id_{};
};

} // namespace raywise
