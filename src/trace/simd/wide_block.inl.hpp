// A ray against four triangles: a filter with proven bounds, and the fast mode.
#if defined(RAYWISE_TRACE_SIMD_WIDE_BLOCK) == defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_BLOCK
#undef RAYWISE_TRACE_SIMD_WIDE_BLOCK
#else
#define RAYWISE_TRACE_SIMD_WIDE_BLOCK
#endif

#include "trace/simd/wide_lanes.inl.hpp"
#include "trace/simd/wide_ray.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/trace/wide.hpp>

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FourLanes = hn::Vec<Four>;

/// Lanes of a block that a query must look at.
struct Candidates {
    using PerLane = std::array<float, TriangleBlock::width>;

    std::uint32_t possible;        ///< may be hit at t in the interval
    std::uint32_t sure;            ///< surely are
    alignas(16) PerLane low, high; ///< t is between, in the watertight mode
    alignas(16) PerLane t, u, v;   ///< of the fast mode
};

/// The triangles of a block in the space where the ray runs from the origin along z.
struct Sheared {
    const WideRay& ray;
    const TriangleBlock& block;

    [[nodiscard]] HWY_INLINE FourLanes depth(std::size_t vertex) const {
        const Four d;
        return hn::Sub(hn::Load(d, row(vertex, 2)), hn::Set(d, ray.origin[2]));
    }

    /// x or y, of a vertex at this depth.
    [[nodiscard]] HWY_INLINE FourLanes
    across(std::size_t vertex, std::size_t axis, FourLanes depth) const {
        const Four d;
        return hn::NegMulAdd(
            hn::Set(d, ray.shear[axis]),
            depth,
            hn::Sub(hn::Load(d, row(vertex, axis)), hn::Set(d, ray.origin[axis]))
        );
    }

private:
    [[nodiscard]] HWY_INLINE const float* row(std::size_t vertex, std::size_t axis) const {
        return floats_at(&block, vertex * sizeof(block.vertices[0]) + ray.rows[axis]);
    }
};

HWY_INLINE FourLanes largest_of(FourLanes a, FourLanes b, FourLanes c) {
    return hn::Max(hn::Max(a, b), c);
}

HWY_INLINE FourLanes least_of(FourLanes a, FourLanes b, FourLanes c) {
    return hn::Min(hn::Min(a, b), c);
}

/// In the watertight mode, with e = 2^-24, s the largest sheared coordinate of a triangle and r = s
/// + its largest depth, an edge function is off by at most e r (20 s + 50 e r), as derived for
/// ExactKernel::surely_misses. A triangle that the ray hits has s <= its doubled extent, up to the
/// rounding of s itself, 5 e z; so that less than its coordinates tells apart most that are missed.
///
/// With u' the computed edge functions, B their error, L the triangle's extent along z and z_i its
/// depths: the true depth z of the hit is within them, the computed one, z', leaves them by at most
/// 2 B L / |sum u'|. sum u' (z_i - z') = 0, so that |z - z'| <= 3 B L / |sum u| where |sum u'|
/// > 5.2 B, and trivially at most L + 2 B L / |sum u'| elsewhere: 7.25 B L / |sum u'| in both
/// cases. The rest is rounding, of the depths, the weights and two quotients.
template <TraceMode mode>
HWY_INLINE Candidates meet_block(const WideRay& ray, const TriangleBlock& block, float limit) {
    const Four d;
    Candidates out; // NOLINT(*-member-init): lanes that nothing selects are not read
    out.possible = 0;
    out.sure = 0;
    const Sheared sheared{ray, block};
    const auto az = sheared.depth(0), bz = sheared.depth(1), cz = sheared.depth(2);
    const auto ax = sheared.across(0, 0, az), ay = sheared.across(0, 1, az);
    const auto bx = sheared.across(1, 0, bz), by = sheared.across(1, 1, bz);
    const auto cx = sheared.across(2, 0, cz), cy = sheared.across(2, 1, cz);
    // Fast: rounded alike on both sides of an edge, so that noise does not make hits of points.
    const auto edge = [](FourLanes px, FourLanes qy, FourLanes py, FourLanes qx) HWY_ATTR {
        if constexpr (mode == TraceMode::fast)
            return hn::Sub(hn::Mul(px, qy), hn::Mul(py, qx));
        else
            return hn::MulSub(px, qy, hn::Mul(py, qx));
    };
    const auto u = edge(bx, cy, by, cx);
    const auto v = edge(cx, ay, cy, ax);
    const auto w = edge(ax, by, ay, bx);
    const auto least = least_of(u, v, w);
    const auto greatest = largest_of(u, v, w);
    const hn::RebindToUnsigned<Four> du;
    const auto prims = hn::Load(du, reinterpret_cast<const std::uint32_t*>(block.prims.data()));
    const auto is_wanted =
        hn::RebindMask(d, hn::Ne(prims, hn::Set(du, static_cast<std::uint32_t>(ray.excluded))));
    // The depth where the edge functions, times this, are the weights.
    const auto depth_at = [&](FourLanes inverse) HWY_ATTR {
        return hn::MulAdd(
            hn::Mul(v, inverse),
            hn::Sub(bz, az),
            hn::MulAdd(hn::Mul(w, inverse), hn::Sub(cz, az), az)
        );
    };
    const auto t_min = hn::Set(d, ray.t_min);
    const auto t_max = hn::Set(d, limit);
    const auto inverse_z = hn::Set(d, ray.shear[2]);
    if constexpr (mode == TraceMode::fast) {
        const auto zero = hn::Zero(d);
        const auto inside = hn::And(is_wanted, hn::Or(hn::Ge(least, zero), hn::Le(greatest, zero)));
        if (hn::AllFalse(d, inside)) return out;
        const auto sum = hn::Add(hn::Add(u, v), w);
        const auto inverse = hn::Div(hn::Set(d, 1.0F), sum);
        const auto t = hn::Mul(depth_at(inverse), inverse_z);
        // The sum of a degenerate triangle is 0 and its t no number.
        const auto hit = hn::And(
            hn::And(inside, hn::Ne(sum, zero)), hn::And(hn::Ge(t, t_min), hn::Le(t, t_max))
        );
        hn::Store(t, d, out.t.data());
        hn::Store(hn::Mul(v, inverse), d, out.u.data());
        hn::Store(hn::Mul(w, inverse), d, out.v.data());
        out.possible = out.sure = bits_of(d, hit);
    } else {
        constexpr float e = unit_roundoff;
        const auto extent = hn::Load(d, block.doubled_extents.data());
        const auto depth = largest_of(hn::Abs(az), hn::Abs(bz), hn::Abs(cz));
        const auto edge_error = [&](FourLanes r, FourLanes s) HWY_ATTR {
            const auto slope =
                hn::MulAdd(r, hn::Set(d, 256 * e * e), hn::Mul(s, hn::Set(d, 24 * e)));
            return hn::MulAdd(r, slope, hn::Set(d, 0x1p-120F));
        };
        const auto most_error = edge_error(hn::Add(depth, extent), extent);
        const auto near_inside = hn::And(
            is_wanted, hn::Or(hn::Ge(least, hn::Neg(most_error)), hn::Le(greatest, most_error))
        );
        if (hn::AllFalse(d, near_inside)) return out;
        const auto inverse = hn::Div(hn::Set(d, 1.0F), hn::Add(hn::Add(u, v), w));
        const auto t = hn::Mul(depth_at(inverse), inverse_z);
        const auto across = hn::Max(
            largest_of(hn::Abs(ax), hn::Abs(bx), hn::Abs(cx)),
            largest_of(hn::Abs(ay), hn::Abs(by), hn::Abs(cy))
        );
        const auto error = edge_error(hn::Add(depth, across), across);
        const auto length = hn::Add(hn::Abs(hn::Sub(bz, az)), hn::Abs(hn::Sub(cz, az)));
        const auto depth_error = hn::MulAdd(
            hn::Mul(error, hn::Abs(inverse)),
            hn::MulAdd(depth, hn::Set(d, 16 * e), hn::Mul(length, hn::Set(d, 7.25F))),
            hn::MulAdd(depth, hn::Set(d, 32 * e), hn::Set(d, 0x1p-120F))
        );
        const auto slowness = hn::Mul(hn::Abs(inverse_z), hn::Set(d, 1 + 0x1p-10F));
        const auto low = hn::NegMulAdd(depth_error, slowness, t);
        const auto high = hn::MulAdd(depth_error, slowness, t);
        hn::Store(low, d, out.low.data());
        hn::Store(high, d, out.high.data());
        // What is no number is possible and not sure.
        const auto outside = hn::Or(hn::Gt(low, t_max), hn::Lt(high, t_min));
        out.possible = bits_of(d, hn::AndNot(outside, near_inside));
        const auto surely_inside =
            hn::And(near_inside, hn::Or(hn::Gt(least, error), hn::Lt(greatest, hn::Neg(error))));
        const auto surely_between = hn::And(hn::Ge(low, t_min), hn::Le(high, t_max));
        out.sure = bits_of(d, hn::And(surely_inside, surely_between));
    }
    return out;
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
