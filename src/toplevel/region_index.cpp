#include <raywise/toplevel/region_index.hpp>

#include <raywise/geometry/region.hpp>
#include <raywise/toplevel/region_bvh.hpp>
#include <raywise/toplevel/region_list.hpp>

#include <cstddef>
#include <span>
#include <variant>

namespace raywise {

AnyRegionIndex
build_region_index(std::span<const Region> regions, const RegionIndexParams& params) {
    constexpr std::size_t list_limit = 8;
    const RegionIndexKind kind = params.kind.value_or(
        regions.size() <= list_limit ? RegionIndexKind::list : RegionIndexKind::bvh
    );
    switch (kind) {
    case RegionIndexKind::octree:
        return RegionOctree(regions, params.octree);
    case RegionIndexKind::bvh:
        return RegionBvh(regions);
    case RegionIndexKind::list:
        break;
    }
    return RegionList(regions);
}

std::size_t bytes(const AnyRegionIndex& index) {
    return std::visit([](const auto& chosen) { return chosen.bytes(); }, index);
}

} // namespace raywise
