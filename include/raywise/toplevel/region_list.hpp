// The plain region index: every region is asked, behind its enclosing box. What the other indices
// mean.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/toplevel/area_id.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace raywise {

/// Answers which regions contain a point by asking all of them; O(areas) per question, best for a
/// handful. Const questions are thread-safe and allocate nothing.
class RegionList {
public:
    RegionList() = default;

    /// Copies the regions; area i is regions[i].
    explicit RegionList(std::span<const Region> regions);

    /// Calls `visit(AreaId)` once for each region that contains the point (its border belongs to
    /// it), in ascending order. A NaN is nowhere.
    template <class Visitor>
    void visit_areas_at(Vec3 point, Visitor&& visit) const {
        const Aabb spot{point, point};
        for (std::size_t i = 0; i < boxes_.size(); ++i) {
            if (overlaps(boxes_[i], spot) && contains(regions_[i], to_double(point)))
                visit(to_area(i));
        }
    }

    /// Number of regions.
    [[nodiscard]] std::size_t size() const { return regions_.size(); }

    /// Memory of the containers.
    [[nodiscard]] std::size_t bytes() const;

private:
    std::vector<Aabb> boxes_;
    std::vector<Region> regions_;
};

} // namespace raywise
