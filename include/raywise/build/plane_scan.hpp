// Both halves of every candidate plane of one axis, from one pass over the primitives.
#pragma once

#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace raywise {

/// A half of a candidate split.
struct Half {
    std::size_t count = 0;
    Aabb box;
};

/// Candidate planes across one axis; a primitive is left of a plane when its centroid is below it.
class PlaneScan {
public:
    /// `planes` in ascending order.
    PlaneScan(
        std::span<const PrimId> prims,
        std::span<const Aabb> boxes,
        std::span<const Vec3> centroids,
        int axis,
        std::span<const float> planes
    );

    [[nodiscard]] const Half& left(std::size_t plane) const { return left_[plane]; }

    [[nodiscard]] const Half& right(std::size_t plane) const { return right_[plane]; }

private:
    std::vector<Half> left_;
    std::vector<Half> right_;
};

/// lo + i (hi - lo) / bins for i in [1, last]: the inner borders of equal bins, ascending.
[[nodiscard]] std::vector<float> place_planes(float lo, float hi, int bins, int last);

} // namespace raywise
