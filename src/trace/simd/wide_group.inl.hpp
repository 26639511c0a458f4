// Rays that go the same way, made ready to be traced together: a ray in every lane.
#if defined(RAYWISE_TRACE_SIMD_WIDE_GROUP) == defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_GROUP
#undef RAYWISE_TRACE_SIMD_WIDE_GROUP
#else
#define RAYWISE_TRACE_SIMD_WIDE_GROUP
#endif

#include "trace/simd/wide_lanes.inl.hpp"
#include "trace/simd/wide_prepare.inl.hpp"
#include "trace/simd/wide_ray.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/ray.hpp>

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Many = hn::CappedTag<float, 16>;
using RayLanes = hn::Vec<Many>;
using RayMask = hn::Mask<Many>;
constexpr std::size_t group_size = hn::MaxLanes(Many());
constexpr std::uint32_t all_of_group = (1U << group_size) - 1; ///< a bit for each

/// One number of every ray.
struct alignas(64) PerRay {
    std::array<float, group_size> items;

    [[nodiscard]] HWY_INLINE RayLanes load() const { return hn::Load(Many(), items.data()); }

    HWY_INLINE void store(RayLanes lanes) { hn::Store(lanes, Many(), items.data()); }
};

/// p * scale + shift of every ray, for planes at p of one axis; see PlaneMaps.
struct GroupMap {
    PerRay scale, shift;

    [[nodiscard]] HWY_INLINE RayLanes at(float plane) const {
        return hn::MulAdd(hn::Set(Many(), plane), scale.load(), shift.load());
    }
};

/// Two lines in p that no ray's p * scale + shift is below, or above, of one of them.
struct GroupBound {
    float scale0, shift0;
    float scale1, shift1;

    [[nodiscard]] HWY_INLINE auto on_first(hn::Vec<Eight> planes) const {
        const Eight d;
        return hn::MulAdd(planes, hn::Set(d, scale0), hn::Set(d, shift0));
    }

    [[nodiscard]] HWY_INLINE auto on_second(hn::Vec<Eight> planes) const {
        const Eight d;
        return hn::MulAdd(planes, hn::Set(d, scale1), hn::Set(d, shift1));
    }
};

/// What WideRay is for one ray. All run toward the same octant, along the same dominant axis.
struct RayGroup {
    std::array<GroupMap, 3> near, far;
    std::array<GroupBound, 3> near_bound, far_bound;
    std::array<std::size_t, 3> near_offset, far_offset; ///< bytes, of the planes in a WideNode
    PerRay t_min, t_max;
    float least_t_min;
    std::array<std::size_t, 3> axes; ///< as turned: the last is dominant
    std::array<PerRay, 3> origin;    ///< of the turned axes
    std::array<PerRay, 3> shear;
    PerRay largest;  ///< magnitude of a component of the direction
    PerRay excluded; ///< as bits
};

/// The floats of the group's rays from byte `offset` on.
HWY_INLINE RayLanes gathered(const Ray* rays, std::size_t offset) {
    const Many d;
    const hn::RebindToSigned<Many> di;
    constexpr std::size_t stride = sizeof(Ray) / sizeof(float);
    const auto places = hn::Mul(hn::Iota(di, 0), hn::Set(di, static_cast<std::int32_t>(stride)));
    return hn::GatherIndex(d, floats_at(rays, offset), places);
}

/// The bounds of what the maps of one axis make of planes within `size`, the largest of coordinates
/// and origins. With c some origin, p * s + h = (p - c) * s + (c * s + h): the first is on one of
/// two lines through 0, the second in an interval. The roundings on the way, of numbers up to
/// 4 S |s|, add up to less than 12 e S |s|.
HWY_INLINE void bound_planes(std::size_t axis, float c, float size, RayGroup& out) {
    const Many d;
    const RayLanes scale = out.near[axis].scale.load();
    const float s0 = hn::GetLane(hn::MinOfLanes(d, scale));
    const float s1 = hn::GetLane(hn::MaxOfLanes(d, scale));
    const float least = hn::GetLane(hn::MinOfLanes(d, out.near[axis].at(c)));
    const float most = hn::GetLane(hn::MaxOfLanes(d, out.far[axis].at(c)));
    // The far scales, rounded as they are from the near ones, have their extremes where those do.
    constexpr float farther = 1 + 16 * unit_roundoff;
    const float f0 = s0 * farther, f1 = s1 * farther;
    const float slack =
        16 * unit_roundoff * size * std::max(std::abs(f0), std::abs(f1)) + 0x1p-100F;
    const float low = least - slack, high = most + slack;
    out.near_bound[axis] = {s0, low - c * s0, s1, low - c * s1};
    out.far_bound[axis] = {f0, high - c * f0, f1, high - c * f1};
}

/// The part of one axis for boxes, as map_planes does it for one ray.
HWY_INLINE void map_group_planes(
    std::size_t axis,
    RayLanes origin,
    RayLanes direction,
    RayLanes slack,
    float size,
    RayGroup& out
) {
    const Many d;
    const RayLanes inverse = hn::Div(hn::Set(d, 1.0F), direction);
    const RayLanes outward = hn::MulAdd(slack, hn::Abs(inverse), hn::Set(d, 0x1p-100F));
    const RayLanes far_inverse = hn::Mul(inverse, hn::Set(d, 1 + 16 * unit_roundoff));
    out.near[axis].scale.store(inverse);
    out.near[axis].shift.store(hn::Neg(hn::MulAdd(origin, inverse, outward)));
    out.far[axis].scale.store(far_inverse);
    out.far[axis].shift.store(hn::NegMulAdd(origin, far_inverse, outward));
    bound_planes(axis, hn::GetLane(origin), size, out);
    constexpr std::size_t row = sizeof(WideNode::planes) / 6;
    const bool rises = hn::GetLane(direction) > 0;
    out.near_offset[axis] = 2 * axis * row + (rises ? 0 : row);
    out.far_offset[axis] = 2 * axis * row + (rises ? row : 0);
}

/// The part for triangles; false when the rays have no dominant axis in common.
HWY_INLINE bool turn_group(
    const std::array<RayLanes, 3>& origin,
    const std::array<RayLanes, 3>& direction,
    RayLanes largest,
    RayGroup& out
) {
    const Many d;
    std::size_t dominant = 0;
    while (dominant < 3 && !hn::AllTrue(d, hn::Eq(hn::Abs(direction[dominant]), largest)))
        ++dominant;
    if (dominant == 3) return false;
    const RayLanes inverse = hn::Div(hn::Set(d, 1.0F), direction[dominant]);
    out.axes = {(dominant + 1) % 3, (dominant + 2) % 3, dominant};
    for (std::size_t i = 0; i < 3; ++i)
        out.origin[i].store(origin[out.axes[i]]);
    for (std::size_t i = 0; i < 2; ++i)
        out.shear[i].store(hn::Div(direction[out.axes[i]], direction[dominant]));
    out.shear[2].store(inverse);
    out.largest.store(largest);
    return true;
}

/// Fills `out` with the next group_size rays; false when they are not alike, or when `prepare`
/// would refuse or change one of them.
HWY_INLINE bool prepare_group(const Ray* rays, const WideBvh& tree, RayGroup& out) {
    constexpr float e = unit_roundoff;
    const Many d;
    std::array<RayLanes, 3> origin, direction;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        origin[axis] = gathered(rays, offsetof(Ray, origin) + axis * sizeof(float));
        direction[axis] = gathered(rays, offsetof(Ray, direction) + axis * sizeof(float));
        const auto falls = hn::Lt(direction[axis], hn::Zero(d));
        if (!hn::AllTrue(d, falls) && !hn::AllFalse(d, falls)) return false;
    }
    const auto largest_of_axes = [](const std::array<RayLanes, 3>& v) HWY_ATTR {
        return hn::Max(hn::Max(hn::Abs(v[0]), hn::Abs(v[1])), hn::Abs(v[2]));
    };
    const RayLanes largest = largest_of_axes(direction);
    if (!turn_group(origin, direction, largest, out)) return false;

    std::array<RayLanes, 3> frame_origin = origin, frame_direction = direction;
    const bool is_world = tree.frame.is_world();
    if (!is_world) {
        const auto along = static_cast<std::size_t>(tree.frame.axis);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto slope = hn::Set(d, tree.frame.slopes[static_cast<int>(axis)]);
            frame_origin[axis] = hn::NegMulAdd(slope, origin[along], origin[axis]);
            frame_direction[axis] = hn::NegMulAdd(slope, direction[along], direction[axis]);
        }
    }
    alignas(16) std::array<float, 4> tree_sizes;
    hn::Store(largest_sizes(tree.box, tree.vertex_bounds), Xyz(), tree_sizes.data());
    std::array<RayLanes, 3> sizes;
    for (std::size_t axis = 0; axis < 3; ++axis)
        sizes[axis] = hn::Max(
            hn::Set(d, tree_sizes[axis]),
            hn::Max(hn::Abs(origin[axis]), hn::Abs(frame_origin[axis]))
        );
    const RayLanes size = largest_of_axes(sizes);
    const RayLanes t_min = gathered(rays, offsetof(Ray, t_min));
    const RayLanes t_max = gathered(rays, offsetof(Ray, t_max));

    // With these comparisons, so that what is no number is refused.
    auto is_fit = hn::And(
        hn::And(hn::Le(size, hn::Set(d, 0x1p60F)), hn::Le(largest, hn::Set(d, 0x1p30F))),
        hn::And(hn::Ge(t_min, hn::Zero(d)), hn::Le(t_min, t_max))
    );
    is_fit = hn::And(is_fit, hn::Ge(largest, hn::Set(d, 0x1p-30F)));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const RayLanes least = hn::Mul(largest, hn::Set(d, e));
        is_fit = hn::And(is_fit, hn::Gt(hn::Abs(frame_direction[axis]), least));
        is_fit = hn::And(is_fit, hn::Le(hn::Abs(origin[axis]), hn::Set(d, 0x1p60F)));
        if (is_world) continue;
        const auto falls = hn::Lt(frame_direction[axis], hn::Zero(d));
        if (!hn::AllTrue(d, falls) && !hn::AllFalse(d, falls)) return false;
    }
    if (!hn::AllTrue(d, is_fit)) return false;

    const float greatest_size = hn::GetLane(hn::MaxOfLanes(d, size));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const RayLanes slack =
            is_world ? hn::Mul(sizes[axis], hn::Set(d, 8 * e)) : hn::Mul(size, hn::Set(d, 24 * e));
        map_group_planes(
            axis, frame_origin[axis], frame_direction[axis], slack, greatest_size, out
        );
    }
    out.t_min.store(hn::Add(t_min, hn::Zero(d))); // no -0
    out.t_max.store(t_max);
    out.least_t_min = hn::GetLane(hn::MinOfLanes(d, out.t_min.load()));
    out.excluded.store(gathered(rays, offsetof(Ray, excluded)));
    return true;
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
