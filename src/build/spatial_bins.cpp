#include <raywise/build/spatial_bins.hpp>

#include <raywise/build/cut_triangle.hpp>
#include <raywise/build/prim_box.hpp>
#include <raywise/build/quad.hpp>
#include <raywise/build/split.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <memory>
#include <mutex>

namespace raywise {

namespace {

/// Where planes across an axis cut a triangle: one end on the edge from its lowest to its highest
/// vertex, the other on one of the two that meet at the middle vertex. No branch, since which edge
/// is next cannot be predicted. Rounded: for prices, not for boxes of a tree.
template <int Axis>
class CrossSection {
public:
    explicit CrossSection(const Corners& corners)
        : low_(corners[0]), middle_(corners[1]), high_(corners[2]) {
        sort(low_, middle_);
        sort(middle_, high_);
        sort(low_, middle_);
        const Quad whole = high_ - low_;
        const Quad lower = middle_ - low_;
        const Quad upper = high_ - middle_;
        const Quad lengths{whole[Axis], lower[Axis], upper[Axis], 1};
        const Quad none = make_quad(0);
        const Quad inverse = lengths > none ? make_quad(1) / lengths : none;
        whole_ = whole * make_quad(inverse[0]);
        lower_ = lower * make_quad(inverse[1]);
        upper_ = upper * make_quad(inverse[2]);
    }

    [[nodiscard]] Quad middle() const { return middle_; }

    /// The section at x, or the vertex that x lies beyond.
    [[nodiscard]] QuadBox operator()(float place) const {
        const Quad x = max(min(make_quad(place), splat(high_)), splat(low_));
        const Quad from_low = x - splat(low_);
        const Quad from_middle = x - splat(middle_);
        const Quad a = low_ + whole_ * from_low;
        const Quad b =
            from_middle < make_quad(0) ? low_ + lower_ * from_low : middle_ + upper_ * from_middle;
        return {min(a, b), max(a, b)};
    }

private:
    [[nodiscard]] static Quad splat(Quad a) { return make_quad(a[Axis]); }

    static void sort(Quad& a, Quad& b) {
        const Quad from = a;
        const auto is_after = splat(b) < splat(a);
        a = is_after ? b : a;
        b = is_after ? from : b;
    }

    Quad low_;
    Quad middle_;
    Quad high_;
    Quad whole_; ///< per unit of the axis
    Quad lower_;
    Quad upper_;
};

} // namespace

SpatialGrid::SpatialGrid(const Aabb& box, int part_count)
    : lo_{box.lo.x, box.lo.y, box.lo.z, 0}
    , last_(make_quad(static_cast<float>(part_count - 1)))
    , part_count_(part_count) {
    // Below this the quotient would overflow; closer planes than a few roundings might coincide.
    constexpr float least_extent = 0x1p-118F;
    constexpr float least_share = 0x1p-20F;
    const Vec3 size = box.size();
    const Vec3 far = max(abs(box.lo), abs(box.hi));
    for (int axis = 0; axis < 3; ++axis) {
        const float step = size[axis] / static_cast<float>(part_count);
        if (size[axis] < least_extent || step < far[axis] * least_share) continue;
        step_[axis] = step;
        scale_[axis] = static_cast<float>(part_count) / size[axis];
    }
}

SpatialBins::SpatialBins(int part_count) // NOLINT(*-member-init): written before read
    : part_count_(part_count) {
    for (std::size_t i = 0; i < at(part_count, 0); ++i) {
        entries_[i] = 0;
        exits_[i] = 0;
        std::construct_at(boxes() + i);
    }
}

void SpatialBins::add(
    const PrimBox* items,
    std::size_t count,
    const TriangleView& triangles,
    const SpatialGrid& grid
) {
    for (std::size_t i = 0; i < count; ++i) {
        const PrimBox& item = items[i];
        const IntQuad first = grid.parts_of(item.lo);
        const IntQuad last = grid.parts_of(item.hi);
        bool is_cut = false;
        for (int axis = 0; axis < 3; ++axis) {
            ++entries_[at(first[axis], axis)];
            ++exits_[at(last[axis], axis)];
            if (first[axis] == last[axis])
                boxes()[at(first[axis], axis)].unite(item.lo, item.hi);
            else
                is_cut = true;
        }
        if (!is_cut) continue;
        const Corners corners = corners_of(triangles, item.id());
        if (first[0] != last[0]) cut<0>(item, corners, grid, first[0], last[0]);
        if (first[1] != last[1]) cut<1>(item, corners, grid, first[1], last[1]);
        if (first[2] != last[2]) cut<2>(item, corners, grid, first[2], last[2]);
    }
}

/// The part between two planes is the hull of the cross sections at both and of the vertices
/// between them.
template <int Axis>
void SpatialBins::cut(
    const PrimBox& item,
    const Corners& corners,
    const SpatialGrid& grid,
    int first,
    int last
) {
    const CrossSection<Axis> section(corners);
    const Quad middle = section.middle();
    QuadBox* boxes = this->boxes();
    float from = item.lo[Axis];
    QuadBox hull = section(from);
    for (int part = first; part <= last; ++part) {
        const float to = part == last ? item.hi[Axis] : grid.plane(Axis, part + 1);
        const QuadBox above = section(to);
        hull.unite(above);
        if (middle[Axis] >= from && middle[Axis] <= to) hull.unite(middle);
        boxes[at(part, Axis)].unite(max(hull.lo, item.lo), min(hull.hi, item.hi));
        hull = above;
        from = to;
    }
}

void SpatialBins::add(const SpatialBins& other) {
    for (std::size_t i = 0; i < at(part_count_, 0); ++i) {
        entries_[i] += other.entries_[i];
        exits_[i] += other.exits_[i];
        boxes()[i].unite(other.boxes()[i]);
    }
}

void fill_bins(
    SpatialBins& bins,
    const PrimRange& range,
    const TriangleView& triangles,
    const SpatialGrid& grid,
    const Executor& executor
) {
    const PrimBox* items = range.from + range.first;
    if (executor.threads() == 1 || range.count() < 2 * prim_chunk) {
        bins.add(items, range.count(), triangles, grid);
        return;
    }
    std::mutex merging;
    executor.for_each_chunk(range.count(), prim_chunk, [&](std::size_t begin, std::size_t end) {
        SpatialBins part(grid.part_count());
        part.add(items + begin, end - begin, triangles, grid);
        const std::scoped_lock lock(merging);
        bins.add(part);
    });
}

} // namespace raywise
