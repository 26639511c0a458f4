#include <raywise/build/plane_scan.hpp>

#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace raywise {

namespace {

void absorb(Half& half, const Half& other) {
    half.count += other.count;
    half.box = unite(half.box, other.box);
}

} // namespace

PlaneScan::PlaneScan(
    std::span<const PrimId> prims,
    std::span<const Aabb> boxes,
    std::span<const Vec3> centroids,
    int axis,
    std::span<const float> planes
)
    : left_(planes.size()), right_(planes.size()) {
    // slabs[i] lies between the planes i - 1 and i.
    std::vector<Half> slabs(planes.size() + 1);
    for (const PrimId prim : prims) {
        const float centroid = centroids[to_index(prim)][axis];
        const auto above = std::upper_bound(planes.begin(), planes.end(), centroid);
        absorb(slabs[static_cast<std::size_t>(above - planes.begin())], {1, boxes[to_index(prim)]});
    }
    Half half;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        absorb(half, slabs[i]);
        left_[i] = half;
    }
    half = {};
    for (std::size_t i = planes.size(); i-- > 0;) {
        absorb(half, slabs[i + 1]);
        right_[i] = half;
    }
}

std::vector<float> place_planes(float lo, float hi, int bins, int last) {
    std::vector<float> planes;
    planes.reserve(static_cast<std::size_t>(last));
    for (int i = 1; i <= last; ++i)
        planes.push_back(lo + static_cast<float>(i) * (hi - lo) / static_cast<float>(bins));
    return planes;
}

} // namespace raywise
