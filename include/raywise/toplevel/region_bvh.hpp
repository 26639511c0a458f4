// A bounding volume hierarchy over the regions' enclosing boxes: the region index for many areas.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/toplevel/area_id.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace raywise {

/// Answers which regions contain a point: O(log areas) where the regions do not overlap, and an
/// exact test for each region whose box holds the point. Const questions are thread-safe and
/// allocate nothing.
class RegionBvh {
public:
    RegionBvh() = default;

    /// Copies the regions; area i is regions[i].
    explicit RegionBvh(std::span<const Region> regions);

    /// Calls `visit(AreaId)` once for each region that contains the point, in no particular order.
    /// A NaN is nowhere.
    template <class Visitor>
    void visit_areas_at(Vec3 point, Visitor&& visit) const {
        if (tree_.is_empty()) return;
        const Aabb spot{point, point};
        // A level pops one node and pushes two.
        std::array<NodeId, Bvh::max_depth + 2> pending{};
        std::size_t count = 1;
        while (count > 0) {
            const Node& node = tree_[pending[--count]];
            if (!overlaps(node.box(), spot)) continue;
            if (!node.is_leaf()) {
                pending[count++] = node.right();
                pending[count++] = node.left();
                continue;
            }
            for (const PrimId region : tree_.prims_of(node)) {
                if (contains(regions_[to_index(region)], to_double(point))) {
                    visit(to_area(to_index(region)));
                }
            }
        }
    }

    /// Number of regions.
    [[nodiscard]] std::size_t size() const { return regions_.size(); }

    /// Memory of the containers.
    [[nodiscard]] std::size_t bytes() const;

private:
    Bvh tree_; ///< its primitives are regions
    std::vector<Region> regions_;
};

} // namespace raywise
