#include <raywise/toplevel/region_octree.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/toplevel/area_id.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

namespace raywise {
namespace {

constexpr std::size_t max_cells = std::size_t{1} << 27U;
constexpr std::size_t max_entries = std::size_t{1} << 30U;

/// Child 4 [x > c] + 2 [y > c] + [z > c]; the center planes belong to both closed boxes.
Aabb child_box(const Aabb& box, Vec3 center, unsigned child) {
    Aabb part = box;
    for (int axis = 0; axis < 3; ++axis) {
        const bool upper = ((child >> static_cast<unsigned>(2 - axis)) & 1U) != 0;
        (upper ? part.lo : part.hi)[axis] = center[axis];
    }
    return part;
}

/// Points on a center plane go to the lower child.
unsigned child_of(Vec3 center, Vec3 point) {
    return (point.x > center.x ? 4U : 0U) + (point.y > center.y ? 2U : 0U) +
           (point.z > center.z ? 1U : 0U);
}

double volume_of(const Aabb& box) {
    const Vec3d size = to_double(box.hi) - to_double(box.lo);
    return size.x * size.y * size.z;
}

/// Whether the region contains every float point of the cell, for the *computed* point test too:
/// that of a slanted region rounds, so the cell must lie inside by more than its rounding error.
bool surely_contains(const Region& region, const Aabb& cell, float slack) {
    if (std::holds_alternative<Aabb>(region)) return contains(region, cell);
    const Vec3 pad{slack, slack, slack};
    return contains(region, Aabb{cell.lo - pad, cell.hi + pad});
}

float largest_coordinate(const Aabb& box) {
    const Vec3 m = max(abs(box.lo), abs(box.hi));
    return std::max({m.x, m.y, m.z});
}

} // namespace

/// Divides cells depth first; the lists of a cell's ancestors are handed down by value.
struct RegionOctree::Builder {
    RegionOctree& tree;
    float slack;

    void fill(
        std::size_t at,
        const Aabb& box,
        int level,
        std::vector<AreaId> containing,
        const std::vector<AreaId>& candidates
    ) {
        std::vector<AreaId> crossing;
        for (const AreaId id : candidates) {
            const Region& region = tree.regions_[static_cast<std::size_t>(id)];
            if (!overlaps(region, box)) continue;
            (surely_contains(region, box, slack) ? containing : crossing).push_back(id);
        }
        if (crossing.empty() || level >= tree.params_.max_level) {
            add_leaf(at, containing, crossing);
            return;
        }
        const std::size_t first = tree.cells_.size();
        if (first + 8 > max_cells || tree.lists_.size() > max_entries) {
            throw Error(ErrorKind::limit, {}, nowhere(), "region octree: too many cells");
        }
        tree.cells_.resize(first + 8);
        tree.cells_[at] = {static_cast<std::uint32_t>(first), false};
        const Vec3 center = box.center();
        for (unsigned child = 0; child < 8; ++child) {
            fill(first + child, child_box(box, center, child), level + 1, containing, crossing);
        }
    }

    void add_leaf(
        std::size_t at,
        const std::vector<AreaId>& containing,
        const std::vector<AreaId>& crossing
    ) {
        tree.cells_[at] = {static_cast<std::uint32_t>(tree.leaves_.size()), true};
        auto& lists = tree.lists_;
        Leaf leaf;
        leaf.first = static_cast<std::uint32_t>(lists.size());
        lists.insert(lists.end(), containing.begin(), containing.end());
        leaf.crossing = static_cast<std::uint32_t>(lists.size());
        lists.insert(lists.end(), crossing.begin(), crossing.end());
        leaf.last = static_cast<std::uint32_t>(lists.size());
        tree.leaves_.push_back(leaf);
    }
};

RegionOctree::RegionOctree(std::span<const Region> regions, const OctreeParams& params)
    : params_(params), regions_(regions.begin(), regions.end()) {
    if (params.max_level < 0 || params.max_level > 10) {
        throw Error("region octree: max_level must be in [0, 10]");
    }
    std::vector<AreaId> all;
    for (std::size_t i = 0; i < regions_.size(); ++i) {
        root_ = unite(root_, bounds(regions_[i]));
        all.push_back(to_area(i));
    }
    if (root_.is_empty()) return;
    cells_.resize(1);
    Builder{*this, largest_coordinate(root_) * 0x1p-22F}.fill(0, root_, 0, {}, all);
    cells_.shrink_to_fit();
    leaves_.shrink_to_fit();
    lists_.shrink_to_fit();
}

const RegionOctree::Leaf* RegionOctree::leaf_at(Vec3 point) const {
    if (!overlaps(root_, Aabb{point, point})) return nullptr;
    Aabb box = root_;
    std::size_t at = 0;
    while (!cells_[at].is_leaf) {
        const Vec3 center = box.center();
        const unsigned child = child_of(center, point);
        box = child_box(box, center, child);
        at = cells_[at].next + child;
    }
    return &leaves_[cells_[at].next];
}

std::size_t RegionOctree::bytes() const {
    return cells_.capacity() * sizeof(Cell) + leaves_.capacity() * sizeof(Leaf) +
           lists_.capacity() * sizeof(AreaId) + regions_.capacity() * sizeof(Region);
}

OctreeStatistics RegionOctree::measure_statistics() const {
    OctreeStatistics result;
    result.nodes = cells_.size();
    result.leaves = leaves_.size();
    result.bytes = bytes();
    result.over_error.assign(regions_.size(), 0);
    result.under_error.assign(regions_.size(), 0);
    for (const Leaf& leaf : leaves_) {
        const std::size_t length = leaf.last - leaf.first;
        result.mean_list_length += static_cast<double>(length);
        result.max_list_length = std::max(result.max_list_length, length);
    }
    if (!leaves_.empty()) result.mean_list_length /= static_cast<double>(leaves_.size());

    struct Visit {
        std::size_t cell;
        Aabb box;
        int level;
    };
    std::vector<Visit> pending;
    if (!cells_.empty()) pending.push_back({0, root_, 1});
    while (!pending.empty()) {
        const Visit visit = pending.back();
        pending.pop_back();
        result.levels = std::max(result.levels, visit.level);
        const Cell& cell = cells_[visit.cell];
        if (!cell.is_leaf) {
            const Vec3 center = visit.box.center();
            for (unsigned child = 0; child < 8; ++child) {
                pending.push_back(
                    {cell.next + child, child_box(visit.box, center, child), visit.level + 1}
                );
            }
            continue;
        }
        const Leaf& leaf = leaves_[cell.next];
        for (std::size_t i = leaf.first; i < leaf.last; ++i) {
            const auto area = static_cast<std::size_t>(lists_[i]);
            result.over_error[area] += volume_of(visit.box);
            if (i < leaf.crossing) result.under_error[area] += volume_of(visit.box);
        }
    }
    for (std::size_t i = 0; i < regions_.size(); ++i) {
        result.over_error[i] = result.over_error[i] / volume(regions_[i]) - 1;
        result.under_error[i] = result.under_error[i] / volume(regions_[i]) - 1;
    }
    return result;
}

} // namespace raywise
