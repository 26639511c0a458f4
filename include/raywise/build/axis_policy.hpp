// Which split axes a builder looks at first: the second seam, beside the hit measure.
#pragma once

#include <raywise/geometry/aabb.hpp>

#include <array>
#include <concepts>

namespace raywise {

/// An axis and how promising it is, in [0, 1].
struct RankedAxis {
    int axis = 0;
    float quality = 1;
};

/// All three axes by decreasing quality; ties in the order x, y, z.
using AxisRanking = std::array<RankedAxis, 3>;

/// A function from a node's box to its ranked axes.
template <class P>
concept AxisPolicy = requires(const P& policy, const Aabb& box) {
    { policy(box) } -> std::same_as<AxisRanking>;
};

} // namespace raywise
