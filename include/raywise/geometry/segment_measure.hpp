// Counted rays as a hit measure: how many of a sample of segments meet a box. After [Bittner09];
// ours: segments that end where their rays were stopped, so that what stands behind is not paid
// for, and counting in lanes.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/ray.hpp>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace raywise {

/// (segments that meet the box + shrinkage a / n) / (n + shrinkage), a the box's half surface area
/// over that of the bounds, n the number of segments: an estimate of the probability that a ray
/// visits a box, drawn toward that of uniform lines where few rays tell. With rays cut where they
/// are stopped (trace/terminate.hpp) and an ordered traversal, meeting is visiting.
///
/// Exactly monotone; counts are those of a slab test in float, which may count a segment that
/// passes within a few roundings of a box. One evaluation takes about 2 ns per segment; `narrowed`
/// leaves those that can matter. Copies share the segments.
class SegmentMeasure {
public:
    /// Rays that are not `is_valid` are left out. `bounds`: those of the scene. `shrinkage` >= 0,
    /// in shares of the number of rays. Throws Error when it is not, or not finite.
    SegmentMeasure(std::span<const Ray> rays, const Aabb& bounds, double shrinkage = 0.5);

    [[nodiscard]] float operator()(const Aabb& box) const;

    /// The same measure for boxes inside `box`, counting only the segments that meet it.
    [[nodiscard]] SegmentMeasure narrowed(const Aabb& box) const;

    /// Number of segments that meet the box.
    [[nodiscard]] std::size_t count(const Aabb& box) const;

    /// Mass of one segment.
    [[nodiscard]] double weight() const { return per_segment_; }

    /// Number of segments that an evaluation tests.
    [[nodiscard]] std::size_t segment_count() const { return segment_count_; }

private:
    struct Block;

    std::shared_ptr<const std::vector<Block>> blocks_;
    std::size_t segment_count_ = 0;
    double per_segment_ = 0;
    double per_area_ = 0;
};

static_assert(NarrowableMeasure<SegmentMeasure>);

} // namespace raywise
