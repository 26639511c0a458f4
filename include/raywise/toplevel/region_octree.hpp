// The octree over regions: cells know which regions contain them and which merely cross them. After
// [Falcone24]; ours: exact answers, containment asked of the cell and not of the region.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/toplevel/area_id.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raywise {

/// What a cell answers about the regions that cross it without containing it.
enum class OctreeMode : std::uint8_t {
    exact, ///< asks them: the right answer
    over,  ///< takes them all: too many areas near borders. The thesis's choice, for faithful runs
    under, ///< takes none: too few. For faithful runs
};

struct OctreeParams {
    int max_level = 5; ///< level of the finest cells, the root's being 0; in [0, 10]
    OctreeMode mode = OctreeMode::exact;
};

/// What an octree looks like; volumes and lists are those of its leaves.
struct OctreeStatistics {
    std::size_t nodes = 0;
    std::size_t leaves = 0;
    int levels = 0;              ///< of nodes: 1 for a root alone, 0 for a tree over nothing
    double mean_list_length = 0; ///< areas per leaf, containing and crossing ones
    std::size_t max_list_length = 0;
    std::size_t bytes = 0;
    /// Per area: volume of the cells that `over` takes for the area, over the region's volume, - 1;
    /// +inf or NaN for flat regions.
    std::vector<double> over_error;
    /// The same of `under`; in [-1, 0] up to rounding, NaN for flat regions.
    std::vector<double> under_error;
};

/// Answers which regions contain a point: O(levels) and an exact test for each region that crosses
/// the cell. Const questions are thread-safe and allocate nothing.
class RegionOctree {
public:
    RegionOctree() = default;

    /// Copies the regions; area i is regions[i]. The root is the union of their enclosing boxes; a
    /// cell is divided while a region crosses it without containing it, down to max_level. Throws
    /// Error for parameters out of range, and of kind `limit` beyond 2^27 cells or 2^30 list
    /// entries.
    explicit RegionOctree(std::span<const Region> regions, const OctreeParams& params = {});

    /// Calls `visit(AreaId)` once for each region that contains the point, in no particular order;
    /// for more or fewer in the modes over and under. A NaN is nowhere.
    template <class Visitor>
    void visit_areas_at(Vec3 point, Visitor&& visit) const {
        const Leaf* const leaf = leaf_at(point);
        if (leaf == nullptr) return;
        std::size_t at = leaf->first;
        for (; at < leaf->crossing; ++at)
            visit(lists_[at]);
        if (params_.mode == OctreeMode::under) return;
        for (; at < leaf->last; ++at) {
            const AreaId id = lists_[at];
            if (params_.mode == OctreeMode::over ||
                contains(regions_[static_cast<std::size_t>(id)], to_double(point))) {
                visit(id);
            }
        }
    }

    /// Number of regions.
    [[nodiscard]] std::size_t size() const { return regions_.size(); }

    [[nodiscard]] const OctreeParams& params() const { return params_; }

    /// Memory of the containers.
    [[nodiscard]] std::size_t bytes() const;

    /// Walks the tree. O(nodes + list entries).
    [[nodiscard]] OctreeStatistics measure_statistics() const;

private:
    /// lists_[first, crossing) contain the cell, lists_[crossing, last) cross it.
    struct Leaf {
        std::uint32_t first = 0;
        std::uint32_t crossing = 0;
        std::uint32_t last = 0;
    };

    /// Eight children from `next` on, or leaf number `next`.
    struct Cell {
        std::uint32_t next = 0;
        bool is_leaf = true;
    };

    struct Builder;

    /// Null outside the root.
    [[nodiscard]] const Leaf* leaf_at(Vec3 point) const;

    OctreeParams params_;
    Aabb root_;
    std::vector<Cell> cells_;
    std::vector<Leaf> leaves_;
    std::vector<AreaId> lists_;
    std::vector<Region> regions_;
};

} // namespace raywise
