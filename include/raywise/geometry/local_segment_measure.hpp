// Counted rays for builders: the fewer of them tell about a node, the more uniform lines count in
// it.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/segment_measure.hpp>

#include <algorithm>
#include <utility>

namespace raywise {

/// A SegmentMeasure whose shrinkage is renewed on the way down a build: inside a box that it was
/// narrowed to, uniform lines count like `pseudo_segments` more segments that meet the box, or as
/// in the whole scene where that is more. Without this a handful of segments would decide how a
/// deep node is split, and other rays would pay for it.
///
/// `narrowed` gives the box itself the mass it had and boxes inside it a better estimate, not the
/// same mass: that suits a builder, which compares within a node, but not what compares nodes all
/// over a tree (reinsertion, node_masses): those take the SegmentMeasure itself.
class LocalSegmentMeasure {
public:
    /// `bounds` as those of `segments`; pseudo_segments >= 0, finite.
    LocalSegmentMeasure(SegmentMeasure segments, const Aabb& bounds, double pseudo_segments = 16)
        : segments_(std::move(segments)), pseudo_segments_(pseudo_segments) {
        const auto area = static_cast<double>(half_area(bounds));
        // What the whole measure gives to uniform lines, per area: that of a box no segment meets.
        const double missed = static_cast<double>(segments_(bounds)) -
                              static_cast<double>(segments_.count(bounds)) * segments_.weight();
        per_area_ = area > 0 ? std::max(missed, 0.0) / area : 0;
        least_per_area_ = segments_.weight() > 0 ? per_area_ / segments_.weight() : 0;
        weight_ = segments_.weight();
    }

    [[nodiscard]] float operator()(const Aabb& box) const {
        if (box.is_empty()) return 0;
        return static_cast<float>(
            static_cast<double>(segments_.count(box)) * weight_ +
            static_cast<double>(half_area(box)) * per_area_
        );
    }

    [[nodiscard]] LocalSegmentMeasure narrowed(const Aabb& box) const {
        LocalSegmentMeasure result = *this;
        result.segments_ = segments_.narrowed(box);
        const auto area = static_cast<double>(half_area(box));
        const auto mass = static_cast<double>((*this)(box));
        const double uniform = std::max(pseudo_segments_, least_per_area_ * area);
        const double all = static_cast<double>(result.segments_.count(box)) + uniform;
        if (!(area > 0) || !(mass > 0) || !(all > 0)) return result;
        result.weight_ = mass / all;
        result.per_area_ = result.weight_ * uniform / area;
        return result;
    }

private:
    SegmentMeasure segments_;
    double pseudo_segments_;
    double weight_ = 0;         ///< of one segment
    double per_area_ = 0;       ///< of uniform lines
    double least_per_area_ = 0; ///< of uniform lines in the whole scene, in segments
};

static_assert(HitMeasure<LocalSegmentMeasure>);

} // namespace raywise
