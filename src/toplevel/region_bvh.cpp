#include <raywise/toplevel/region_bvh.hpp>

#include <raywise/build/binned.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/region.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace raywise {

RegionBvh::RegionBvh(std::span<const Region> regions) : regions_(regions.begin(), regions.end()) {
    std::vector<Aabb> boxes;
    boxes.reserve(regions.size());
    for (const Region& region : regions)
        boxes.push_back(bounds(region));
    // Points are looked up, not rays; the surface area still separates the boxes well.
    tree_ = build_binned(boxes, SurfaceMeasure{});
}

std::size_t RegionBvh::bytes() const {
    return tree_.nodes.capacity() * sizeof(Node) + tree_.prims.capacity() * sizeof(PrimId) +
           regions_.capacity() * sizeof(Region);
}

} // namespace raywise
