// From a point to the influence areas around it: the question, and the closed set of structures
// that answer it.
#pragma once

#include <raywise/geometry/region.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/toplevel/area_id.hpp>
#include <raywise/toplevel/region_bvh.hpp>
#include <raywise/toplevel/region_list.hpp>
#include <raywise/toplevel/region_octree.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace raywise {

/// A structure that tells which regions contain a point, each once, in any order.
template <class I>
concept RegionIndex = requires(const I& index, Vec3 point, void (*visit)(AreaId)) {
    index.visit_areas_at(point, visit);
    { index.size() } -> std::same_as<std::size_t>;
    { index.bytes() } -> std::same_as<std::size_t>;
};

static_assert(RegionIndex<RegionList> && RegionIndex<RegionOctree> && RegionIndex<RegionBvh>);

/// Chosen at run time.
using AnyRegionIndex = std::variant<RegionList, RegionOctree, RegionBvh>;

enum class RegionIndexKind : std::uint8_t { list, octree, bvh };

struct RegionIndexParams {
    /// Absent: a list up to eight regions, beyond that a BVH.
    std::optional<RegionIndexKind> kind{};
    OctreeParams octree{}; ///< of the octree only
};

/// Copies the regions; area i is regions[i]. Throws Error for parameters out of range.
[[nodiscard]] AnyRegionIndex
build_region_index(std::span<const Region> regions, const RegionIndexParams& params = {});

/// Calls `visit(AreaId)` for the areas at the point; see the index's own contract.
template <class Visitor>
void visit_areas_at(const AnyRegionIndex& index, Vec3 point, Visitor&& visit) {
    std::visit(
        [&](const auto& chosen) { chosen.visit_areas_at(point, std::forward<Visitor>(visit)); },
        index
    );
}

/// Appends the areas at the point to `found`, which is not cleared; allocates only when it must
/// grow.
template <RegionIndex Index>
void append_areas_at(const Index& index, Vec3 point, std::vector<AreaId>& found) {
    index.visit_areas_at(point, [&](AreaId id) { found.push_back(id); });
}

/// Memory of the index's containers.
[[nodiscard]] std::size_t bytes(const AnyRegionIndex& index);

} // namespace raywise
