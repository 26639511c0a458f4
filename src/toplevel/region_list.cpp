#include <raywise/toplevel/region_list.hpp>

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/region.hpp>

#include <cstddef>
#include <span>

namespace raywise {

RegionList::RegionList(std::span<const Region> regions) : regions_(regions.begin(), regions.end()) {
    boxes_.reserve(regions.size());
    for (const Region& region : regions)
        boxes_.push_back(bounds(region));
}

std::size_t RegionList::bytes() const {
    return boxes_.capacity() * sizeof(Aabb) + regions_.capacity() * sizeof(Region);
}

} // namespace raywise
