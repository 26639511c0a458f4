// Which split axes a builder looks at first: the second seam, beside the hit measure. LSPH and SPFH
// after [Falcone24].
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <utility>

namespace raywise {

/// An axis and how promising it is, in [0, 1].
struct RankedAxis {
    int axis = 0;
    float quality = 1;

    friend constexpr bool operator==(const RankedAxis&, const RankedAxis&) = default;
};

/// All three axes by decreasing quality; ties in the order x, y, z.
using AxisRanking = std::array<RankedAxis, 3>;

/// A function from a node's box to its ranked axes.
template <class P>
concept AxisPolicy = requires(const P& policy, const Aabb& box) {
    { policy(box) } -> std::same_as<AxisRanking>;
};

/// The axes by decreasing quality; ties keep the order x, y, z.
[[nodiscard]] constexpr AxisRanking rank_axes(float x, float y, float z) {
    AxisRanking axes{{{0, x}, {1, y}, {2, z}}};
    // Three exchanges of strict neighbors sort three and keep ties in place.
    if (axes[0].quality < axes[1].quality) std::swap(axes[0], axes[1]);
    if (axes[1].quality < axes[2].quality) std::swap(axes[1], axes[2]);
    if (axes[0].quality < axes[1].quality) std::swap(axes[0], axes[1]);
    return axes;
}

/// Every axis is as good as another.
struct AllAxes {
    [[nodiscard]] constexpr AxisRanking operator()(const Aabb&) const { return rank_axes(1, 1, 1); }
};

/// Longest splitting plane heuristic: quality = side / longest side; 1 for all of a point.
struct LongestAxis {
    [[nodiscard]] constexpr AxisRanking operator()(const Aabb& box) const {
        const Vec3 side = box.size();
        const float longest = std::max({side.x, side.y, side.z});
        if (!(longest > 0)) return rank_axes(1, 1, 1);
        return rank_axes(side.x / longest, side.y / longest, side.z / longest);
    }
};

/// A function from a node's box to the direction of the rays that meet it; any length.
template <class D>
concept DirectionAt = requires(const D& direction, const Aabb& box) {
    { direction(box) } -> std::convertible_to<Vec3d>;
};

/// Splitting plane facing heuristic: quality = (1 - share)^2, share = |v_k| / (|v_x| + |v_y| +
/// |v_z|), v the direction of the rays at the node. A split plane that contains the rays ranks
/// first. 1 for all when the direction is zero or not finite.
template <DirectionAt D>
class FacingAxis {
public:
    explicit FacingAxis(D direction_at) : direction_at_(std::move(direction_at)) {}

    [[nodiscard]] AxisRanking operator()(const Aabb& box) const {
        const Vec3d v = abs(Vec3d(direction_at_(box)));
        const double sum = v.x + v.y + v.z;
        if (!(sum > 0) || !std::isfinite(sum)) return rank_axes(1, 1, 1);
        const auto quality = [&](double part) {
            const double rest = 1.0 - part / sum;
            return static_cast<float>(rest * rest);
        };
        return rank_axes(quality(v.x), quality(v.y), quality(v.z));
    }

private:
    D direction_at_;
};

/// The facing of one direction everywhere, as for parallel rays.
struct SameDirection {
    Vec3d direction{0, 0, 1};

    [[nodiscard]] Vec3d operator()(const Aabb&) const { return direction; }
};

/// Lets a three-axis builder skip what the policy ranks below the threshold, unless no other axis
/// can split. With the default nothing is skipped.
template <AxisPolicy P = AllAxes>
struct AxisFilter {
    P policy{};
    float threshold = 0; ///< least quality of an axis that is tried, in [0, 1]
};

/// Which of x, y, z the filter lets through at a node.
template <AxisPolicy P>
[[nodiscard]] std::array<bool, 3> wanted_axes(const AxisFilter<P>& filter, const Aabb& box) {
    std::array<bool, 3> result{};
    for (const RankedAxis& ranked : filter.policy(box))
        result[static_cast<std::size_t>(ranked.axis)] = ranked.quality >= filter.threshold;
    return result;
}

static_assert(AxisPolicy<AllAxes> && AxisPolicy<LongestAxis>);
static_assert(AxisPolicy<FacingAxis<SameDirection>>);

} // namespace raywise
