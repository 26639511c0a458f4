// How a ray is made ready, all axes at once.
#if defined(RAYWISE_TRACE_SIMD_WIDE_PREPARE) ==                                                    \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_PREPARE
#undef RAYWISE_TRACE_SIMD_WIDE_PREPARE
#else
#define RAYWISE_TRACE_SIMD_WIDE_PREPARE
#endif

#include "trace/simd/wide_lanes.inl.hpp"
#include "trace/simd/wide_ray.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// x, y, z and nothing.
using Xyz = hn::FixedTag<float, 4>;
using XyzLanes = hn::Vec<Xyz>;

/// By dominant axis: z is that one, x and y follow it in turn.
alignas(16) constexpr std::array<std::array<std::uint32_t, 4>, 3> turned_axes{
    {{1, 2, 0, 3}, {2, 0, 1, 3}, {0, 1, 2, 3}}
};
constexpr std::uint32_t block_row = sizeof(TriangleBlock::vertices) / 9;
constexpr std::array<std::array<std::uint32_t, 3>, 3> turned_rows{
    {{block_row, 2 * block_row, 0}, {2 * block_row, 0, block_row}, {0, block_row, 2 * block_row}}
};

HWY_INLINE XyzLanes lower_corner(const Aabb& box) {
    return hn::LoadU(Xyz(), &box.lo.x);
}

HWY_INLINE XyzLanes upper_corner(const Aabb& box) {
    return hn::Shuffle0321(hn::LoadU(Xyz(), &box.lo.z)); // z, then the other corner
}

/// Of both corners of both boxes, the largest magnitudes by axis.
HWY_INLINE XyzLanes largest_sizes(const Aabb& a, const Aabb& b) {
    const auto largest = [](const Aabb& box) HWY_ATTR {
        return hn::Max(hn::Abs(lower_corner(box)), hn::Abs(upper_corner(box)));
    };
    return hn::Max(largest(a), largest(b));
}

/// The part for boxes, of a ray in their frame without components that are too small; `slack` is
/// how far planes move outward.
HWY_INLINE void map_planes(XyzLanes o, XyzLanes direction, XyzLanes slack, PlaneMaps& out) {
    const Xyz d;
    const auto inverse = hn::Div(hn::Set(d, 1.0F), direction);
    const auto outward = hn::MulAdd(slack, hn::Abs(inverse), hn::Set(d, 0x1p-100F));
    const auto far_inverse = hn::Mul(inverse, hn::Set(d, 1 + 16 * unit_roundoff));
    hn::Store(inverse, d, out.near_scale.data());
    hn::Store(hn::Neg(hn::MulAdd(o, inverse, outward)), d, out.near_shift.data());
    hn::Store(far_inverse, d, out.far_scale.data());
    hn::Store(hn::NegMulAdd(o, far_inverse, outward), d, out.far_shift.data());

    // The lower planes of an axis are followed by the upper ones, which are near when the ray
    // falls.
    constexpr std::uint32_t row = sizeof(WideNode::planes) / 6;
    static_assert(row == 1U << (31 - 26));
    const hn::RebindToUnsigned<Xyz> du;
    const auto lower = hn::Mul(hn::Iota(du, 0), hn::Set(du, 2 * row));
    const auto turned = hn::And(hn::ShiftRight<26>(hn::BitCast(du, direction)), hn::Set(du, row));
    const auto near = hn::Or(lower, turned);
    hn::Store(near, du, out.near_offset.data());
    hn::Store(hn::Xor(near, hn::Set(du, row)), du, out.far_offset.data());
}

/// Fills `out`; false where float arithmetic could overflow or lose its bounds: coordinates beyond
/// 2^60, or a direction whose largest component is outside [2^-30, 2^30]; and for rays that are not
/// `is_valid`.
HWY_INLINE bool prepare(const Ray& ray, const WideBvh& tree, WideRay& out) {
    constexpr float e = unit_roundoff;
    const Xyz d;
    const auto is_axis = hn::FirstN(d, 3);
    static_assert(offsetof(Ray, direction) + sizeof(Xyz) <= sizeof(Ray));
    const XyzLanes o = hn::IfThenElseZero(is_axis, hn::LoadU(d, &ray.origin.x));
    const XyzLanes direction = hn::IfThenElseZero(is_axis, hn::LoadU(d, &ray.direction.x));
    const XyzLanes largest = hn::MaxOfLanes(d, hn::Abs(direction));
    const float m = hn::GetLane(largest);

    const XyzLanes tree_sizes =
        hn::IfThenElseZero(is_axis, largest_sizes(tree.box, tree.vertex_bounds));
    XyzLanes frame_o = o, frame_direction = direction;
    XyzLanes sizes = hn::Max(tree_sizes, hn::Abs(o));
    XyzLanes slack = hn::Mul(sizes, hn::Set(d, 8 * e));
    if (!tree.frame.is_world()) {
        const XyzLanes slopes = hn::IfThenElseZero(is_axis, hn::LoadU(d, &tree.frame.slopes.x));
        frame_o = hn::NegMulAdd(slopes, hn::Set(d, ray.origin[tree.frame.axis]), o);
        frame_direction =
            hn::NegMulAdd(slopes, hn::Set(d, ray.direction[tree.frame.axis]), direction);
        sizes = hn::Max(sizes, hn::Abs(frame_o));
        slack = hn::Mul(hn::MaxOfLanes(d, sizes), hn::Set(d, 24 * e));
    }
    // In this order and with these comparisons, so that what is no number is refused.
    const auto is_small = hn::And(
        hn::And(hn::Le(hn::Abs(o), hn::Set(d, 0x1p60F)), hn::Le(sizes, hn::Set(d, 0x1p60F))),
        hn::Le(hn::Abs(direction), hn::Set(d, 0x1p30F))
    );
    if (!(hn::AllTrue(d, is_small) && m >= 0x1p-30F && ray.t_min >= 0 && ray.t_min <= ray.t_max))
        [[unlikely]]
        return false;
    // A branch, so that the inverse need not wait for what is the largest.
    const auto is_flat =
        hn::And(is_axis, hn::Le(hn::Abs(frame_direction), hn::Mul(largest, hn::Set(d, e))));
    if (!hn::AllFalse(d, is_flat)) [[unlikely]] {
        const XyzLanes least = hn::CopySign(hn::Mul(largest, hn::Set(d, 4 * e)), frame_direction);
        frame_direction = hn::IfThenElse(is_flat, least, frame_direction);
        slack =
            hn::IfThenElse(is_flat, hn::Mul(hn::MaxOfLanes(d, sizes), hn::Set(d, 32 * e)), slack);
    }
    map_planes(frame_o, frame_direction, slack, out.planes);
    out.t_min = ray.t_min + 0.0F; // no -0
    out.t_max = ray.t_max;
    out.largest = m;

    const auto z =
        static_cast<std::size_t>(std::countr_zero(bits_of(d, hn::Eq(hn::Abs(direction), largest))));
    const auto order = hn::SetTableIndices(d, turned_axes[z].data());
    const auto turned = [&](XyzLanes v) HWY_ATTR { return hn::TableLookupLanes(v, order); };
    const XyzLanes turned_direction = turned(direction);
    const auto is_dominant = hn::Eq(hn::Iota(d, 0), hn::Set(d, 2.0F));
    const XyzLanes shear = hn::Div(
        hn::IfThenElse(is_dominant, hn::Set(d, 1.0F), turned_direction),
        hn::Broadcast<2>(turned_direction)
    );
    hn::Store(turned(o), d, out.origin.data());
    hn::Store(shear, d, out.shear.data());
    out.rows = turned_rows[z];

    out.excluded = ray.excluded;
    return true;
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
