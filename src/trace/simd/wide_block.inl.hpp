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

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Lanes of a block that a query must look at.
struct Candidates {
    std::uint32_t possible; ///< may be hit at t in the interval
    std::uint32_t sure;     ///< surely are
    alignas(16) std::array<float, TriangleBlock::width> t;
    alignas(16) std::array<float, TriangleBlock::width> t_error; ///< of the watertight mode
    alignas(16) std::array<float, TriangleBlock::width> u, v;    ///< of the fast mode
};

template <TraceMode mode>
HWY_INLINE Candidates meet_block(const WideRay& ray, const TriangleBlock& block, float limit) {
    const Four d;
    Candidates out;
    out.possible = 0;
    out.sure = 0;
    for (std::size_t first = 0; first < TriangleBlock::width; first += hn::Lanes(d)) {
        constexpr std::size_t vertex_size = sizeof(block.vertices[0]);
        const auto depth_of = [&](std::size_t vertex) HWY_ATTR {
            return hn::Sub(
                hn::Load(d, floats_at(&block, vertex * vertex_size + ray.z) + first),
                hn::Set(d, ray.origin_z)
            );
        };
        const auto sheared =
            [&](std::size_t vertex, std::size_t axis, float origin, float shear, auto depth)
                HWY_ATTR {
                    return hn::NegMulAdd(
                        hn::Set(d, shear),
                        depth,
                        hn::Sub(
                            hn::Load(d, floats_at(&block, vertex * vertex_size + axis) + first),
                            hn::Set(d, origin)
                        )
                    );
                };
        const auto az = depth_of(0), bz = depth_of(1), cz = depth_of(2);
        const auto ax = sheared(0, ray.x, ray.origin_x, ray.shear_x, az);
        const auto ay = sheared(0, ray.y, ray.origin_y, ray.shear_y, az);
        const auto bx = sheared(1, ray.x, ray.origin_x, ray.shear_x, bz);
        const auto by = sheared(1, ray.y, ray.origin_y, ray.shear_y, bz);
        const auto cx = sheared(2, ray.x, ray.origin_x, ray.shear_x, cz);
        const auto cy = sheared(2, ray.y, ray.origin_y, ray.shear_y, cz);
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
        const auto least = hn::Min(hn::Min(u, v), w);
        const auto greatest = hn::Max(hn::Max(u, v), w);
        const auto prims = hn::Load(
            hn::RebindToUnsigned<Four>(),
            reinterpret_cast<const std::uint32_t*>(block.prims.data()) + first
        );
        const auto is_wanted = hn::RebindMask(
            d,
            hn::Ne(
                prims,
                hn::Set(hn::RebindToUnsigned<Four>(), static_cast<std::uint32_t>(ray.excluded))
            )
        );
        if constexpr (mode == TraceMode::fast) {
            const auto zero = hn::Zero(d);
            const auto inside =
                hn::And(is_wanted, hn::Or(hn::Ge(least, zero), hn::Le(greatest, zero)));
            if (hn::AllFalse(d, inside)) continue;
            const auto sum = hn::Add(hn::Add(u, v), w);
            const auto inverse = hn::Div(hn::Set(d, 1.0F), sum);
            const auto weight_b = hn::Mul(v, inverse), weight_c = hn::Mul(w, inverse);
            const auto depth =
                hn::MulAdd(weight_b, hn::Sub(bz, az), hn::MulAdd(weight_c, hn::Sub(cz, az), az));
            const auto t = hn::Mul(depth, hn::Set(d, ray.inverse_z));
            // The sum of a degenerate triangle is 0 and its t no number.
            const auto hit = hn::And(
                hn::And(inside, hn::Ne(sum, zero)),
                hn::And(hn::Ge(t, hn::Set(d, ray.t_min)), hn::Le(t, hn::Set(d, limit)))
            );
            hn::Store(t, d, out.t.data() + first);
            hn::Store(weight_b, d, out.u.data() + first);
            hn::Store(weight_c, d, out.v.data() + first);
            const std::uint32_t bits = bits_of(d, hit) << first;
            out.possible |= bits;
            out.sure |= bits;
        } else {
            const auto extent = hn::Load(d, block.doubled_extents.data() + first);
            const auto error = hn::MulAdd(
                extent, hn::Set(d, ray.edge_error_scale), hn::Set(d, ray.edge_error_shift)
            );
            const auto negative_error = hn::Neg(error);
            const auto near_inside =
                hn::And(is_wanted, hn::Or(hn::Ge(least, negative_error), hn::Le(greatest, error)));
            if (hn::AllFalse(d, near_inside)) continue;
            const auto sum = hn::Add(hn::Add(u, v), w);
            const auto inverse = hn::Div(hn::Set(d, 1.0F), sum);
            const auto depth = hn::MulAdd(
                hn::Mul(v, inverse),
                hn::Sub(bz, az),
                hn::MulAdd(hn::Mul(w, inverse), hn::Sub(cz, az), az)
            );
            const auto t = hn::Mul(depth, hn::Set(d, ray.inverse_z));
            const auto t_error = hn::MulAdd(
                hn::Mul(error, hn::Abs(inverse)),
                hn::MulAdd(extent, hn::Set(d, ray.t_error_scale), hn::Set(d, ray.t_error_slope)),
                hn::Set(d, ray.t_error_shift)
            );
            hn::Store(t, d, out.t.data() + first);
            hn::Store(t_error, d, out.t_error.data() + first);
            const auto low = hn::Sub(t, t_error), high = hn::Add(t, t_error);
            // What is no number is possible and not sure.
            const auto outside =
                hn::Or(hn::Gt(low, hn::Set(d, limit)), hn::Lt(high, hn::Set(d, ray.t_min)));
            out.possible |= bits_of(d, hn::AndNot(outside, near_inside)) << first;
            // Vertices may be farther from the ray than those of a triangle that it hits; within
            // twice that distance, twice the error and some more is enough.
            const auto is_close = hn::Le(hn::Max(hn::Abs(ax), hn::Abs(ay)), extent);
            const auto most_error = hn::Mul(hn::Set(d, 4.0F), error);
            const auto surely_inside = hn::And(
                hn::And(near_inside, is_close),
                hn::Or(hn::Gt(least, most_error), hn::Lt(greatest, hn::Neg(most_error)))
            );
            const auto surely_between =
                hn::And(hn::Ge(low, hn::Set(d, ray.t_min)), hn::Le(high, hn::Set(d, limit)));
            out.sure |= bits_of(d, hn::And(surely_inside, surely_between)) << first;
        }
    }
    return out;
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif
