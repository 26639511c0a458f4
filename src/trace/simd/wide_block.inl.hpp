// Rays against triangles, lane by lane: a filter with proven bounds, and the fast mode.
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

/// A vertex in the space where the ray runs from the origin along z, lane by lane.
template <class D>
struct ShearedVertex {
    hn::Vec<D> x, y, z;
};

/// Of rays and triangles, lane by lane.
template <class D>
struct Encounter {
    ShearedVertex<D> a, b, c;
    hn::Vec<D> doubled_extent; ///< of the triangle
    hn::Vec<D> inverse_z;      ///< of the ray's direction
    hn::Vec<D> t_min, t_max;
    hn::Mask<D> is_wanted; ///< whether the ray may hit the triangle at all
};

/// What is known of them.
template <class D>
struct Meeting {
    hn::Mask<D> possible; ///< may be hit at t in the interval
    hn::Mask<D> sure;     ///< surely are
    hn::Vec<D> low, high; ///< t is between; of the fast mode both are t
    hn::Vec<D> u, v;      ///< of the fast mode
};

template <class V>
HWY_INLINE V largest_of(V a, V b, V c) {
    return hn::Max(hn::Max(a, b), c);
}

template <class V>
HWY_INLINE V least_of(V a, V b, V c) {
    return hn::Min(hn::Min(a, b), c);
}

/// False where no lane is possible; fills `out` otherwise.
///
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
template <TraceMode mode, class D>
HWY_INLINE bool meet(D d, const Encounter<D>& at, Meeting<D>& out) {
    const auto& [ax, ay, az] = at.a;
    const auto& [bx, by, bz] = at.b;
    const auto& [cx, cy, cz] = at.c;
    // Fast: rounded alike on both sides of an edge, so that noise does not make hits of points.
    const auto edge = [](auto px, auto qy, auto py, auto qx) HWY_ATTR {
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
    // The depth where the edge functions, times this, are the weights.
    const auto depth_at = [&](auto inverse) HWY_ATTR {
        return hn::MulAdd(
            hn::Mul(v, inverse),
            hn::Sub(bz, az),
            hn::MulAdd(hn::Mul(w, inverse), hn::Sub(cz, az), az)
        );
    };
    if constexpr (mode == TraceMode::fast) {
        const auto zero = hn::Zero(d);
        const auto inside =
            hn::And(at.is_wanted, hn::Or(hn::Ge(least, zero), hn::Le(greatest, zero)));
        if (hn::AllFalse(d, inside)) return false;
        const auto sum = hn::Add(hn::Add(u, v), w);
        const auto inverse = hn::Div(hn::Set(d, 1.0F), sum);
        const auto t = hn::Mul(depth_at(inverse), at.inverse_z);
        // The sum of a degenerate triangle is 0 and its t no number.
        const auto is_between = hn::And(hn::Ge(t, at.t_min), hn::Le(t, at.t_max));
        out.possible = out.sure = hn::And(hn::And(inside, hn::Ne(sum, zero)), is_between);
        out.low = out.high = t;
        out.u = hn::Mul(v, inverse);
        out.v = hn::Mul(w, inverse);
    } else {
        constexpr float e = unit_roundoff;
        const auto depth = largest_of(hn::Abs(az), hn::Abs(bz), hn::Abs(cz));
        const auto edge_error = [&](auto r, auto s) HWY_ATTR {
            const auto slope =
                hn::MulAdd(r, hn::Set(d, 256 * e * e), hn::Mul(s, hn::Set(d, 24 * e)));
            return hn::MulAdd(r, slope, hn::Set(d, 0x1p-120F));
        };
        const auto most_error = edge_error(hn::Add(depth, at.doubled_extent), at.doubled_extent);
        const auto near_inside = hn::And(
            at.is_wanted, hn::Or(hn::Ge(least, hn::Neg(most_error)), hn::Le(greatest, most_error))
        );
        if (hn::AllFalse(d, near_inside)) return false;
        const auto inverse = hn::Div(hn::Set(d, 1.0F), hn::Add(hn::Add(u, v), w));
        const auto t = hn::Mul(depth_at(inverse), at.inverse_z);
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
        const auto slowness = hn::Mul(hn::Abs(at.inverse_z), hn::Set(d, 1 + 0x1p-10F));
        out.low = hn::NegMulAdd(depth_error, slowness, t);
        out.high = hn::MulAdd(depth_error, slowness, t);
        // What is no number is possible and not sure.
        const auto outside = hn::Or(hn::Gt(out.low, at.t_max), hn::Lt(out.high, at.t_min));
        out.possible = hn::AndNot(outside, near_inside);
        const auto surely_inside =
            hn::And(near_inside, hn::Or(hn::Gt(least, error), hn::Lt(greatest, hn::Neg(error))));
        const auto surely_between = hn::And(hn::Ge(out.low, at.t_min), hn::Le(out.high, at.t_max));
        out.sure = hn::And(surely_inside, surely_between);
    }
    return true;
}

/// Lanes of a block that a query must look at.
struct Candidates {
    using PerLane = std::array<float, TriangleBlock::width>;

    std::uint32_t possible; ///< as of a Meeting
    std::uint32_t sure;
    alignas(16) PerLane low, high;
    alignas(16) PerLane u, v; ///< of the fast mode
};

/// Bytes of a vertex's coordinates in a TriangleBlock.
constexpr std::size_t vertex_row = sizeof(TriangleBlock::vertices) / 3;

/// One ray and the four triangles of a block.
HWY_INLINE Encounter<Four> encounter(const WideRay& ray, const TriangleBlock& block, float limit) {
    const Four d;
    const auto seen = [&](std::size_t vertex, std::size_t axis) HWY_ATTR {
        const float* const lanes = floats_at(&block, vertex * vertex_row + ray.rows[axis]);
        return hn::Sub(hn::Load(d, lanes), hn::Set(d, ray.origin[axis]));
    };
    const auto sheared = [&](std::size_t vertex) HWY_ATTR {
        const auto z = seen(vertex, 2);
        const auto across = [&](std::size_t axis) HWY_ATTR {
            return hn::NegMulAdd(hn::Set(d, ray.shear[axis]), z, seen(vertex, axis));
        };
        return ShearedVertex<Four>{across(0), across(1), z};
    };
    const hn::RebindToUnsigned<Four> du;
    const auto prims = hn::Load(du, reinterpret_cast<const std::uint32_t*>(block.prims.data()));
    return {
        sheared(0),
        sheared(1),
        sheared(2),
        hn::Load(d, block.doubled_extents.data()),
        hn::Set(d, ray.shear[2]),
        hn::Set(d, ray.t_min),
        hn::Set(d, limit),
        hn::RebindMask(d, hn::Ne(prims, hn::Set(du, static_cast<std::uint32_t>(ray.excluded))))
    };
}

template <TraceMode mode>
HWY_INLINE Candidates meet_block(const WideRay& ray, const TriangleBlock& block, float limit) {
    const Four d;
    Candidates out; // NOLINT(*-member-init): lanes that nothing selects are not read
    out.possible = 0;
    out.sure = 0;
    Meeting<Four> found;
    if (!meet<mode>(d, encounter(ray, block, limit), found)) return out;
    hn::Store(found.low, d, out.low.data());
    if constexpr (mode == TraceMode::fast) {
        hn::Store(found.u, d, out.u.data());
        hn::Store(found.v, d, out.v.data());
    } else {
        hn::Store(found.high, d, out.high.data());
    }
    out.possible = bits_of(d, found.possible);
    out.sure = bits_of(d, found.sure);
    return out;
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
