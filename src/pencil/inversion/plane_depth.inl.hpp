// The depths at which rays meet the plane of a triangle, a vector of rays at a time. Included once
// for every instruction set.
#if defined(RAYWISE_PENCIL_INVERSION_PLANE_DEPTH) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_INVERSION_PLANE_DEPTH
#undef RAYWISE_PENCIL_INVERSION_PLANE_DEPTH
#else
#define RAYWISE_PENCIL_INVERSION_PLANE_DEPTH
#endif

#include "pencil/inversion/drawn.hpp"
#include "pencil/inversion/edges.hpp"
#include "pencil/inversion/ray_tiles.hpp"

#include <hwy/highway.h>

#include <array>
#include <cmath>
#include <cstddef>

HWY_BEFORE_NAMESPACE();

namespace raywise::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using Mask = hn::Mask<D>;

/// Depth is top / bottom, both weighted sums of the edge functions, which are raised.
HWY_INLINE void radial_depth(
    const Drawn& t,
    const Edges& edges,
    bool is_reversed,
    V e0,
    V e1,
    V e2,
    V& least,
    V& most
) {
    const D d;
    const auto bound = static_cast<double>(edges.bound);
    V top_lo, top_hi, bottom_lo, bottom_hi;
    const V sum = hn::Add(hn::Add(e0, e1), e2);
    float unsure = 0x1p-17F;
    if (edges.is_flat) {
        const std::array<double, 3> inverse{1 / t.p[0].h, 1 / t.p[1].h, 1 / t.p[2].h};
        const auto part = [&](V e, std::size_t i) HWY_ATTR {
            return hn::Mul(e, hn::Set(d, static_cast<float>(inverse[i])));
        };
        const double inverses = inverse[0] + inverse[1] + inverse[2];
        top_hi = sum;
        top_lo = hn::Sub(sum, hn::Set(d, static_cast<float>(6.1 * bound)));
        bottom_hi = hn::Add(hn::Add(part(e0, 0), part(e1, 1)), part(e2, 2));
        bottom_lo = hn::Sub(bottom_hi, hn::Set(d, static_cast<float>(2.1 * bound * inverses)));
    } else {
        top_lo = top_hi = hn::Set(d, static_cast<float>(edges.volume));
        bottom_hi = sum;
        bottom_lo = hn::Sub(sum, hn::Set(d, static_cast<float>(6.1 * bound)));
        unsure += static_cast<float>(edges.volume_error * 1.01);
    }
    const V nearest = hn::Mul(hn::Div(top_lo, bottom_hi), hn::Set(d, 1 - unsure));
    const V farthest = hn::Mul(hn::Div(top_hi, bottom_lo), hn::Set(d, 1 + unsure));
    // Rounding the differences above is relative to what they were taken from.
    const Mask is_bounded = hn::Gt(bottom_lo, hn::Mul(bottom_hi, hn::Set(d, 0x1p-4F)));
    const Mask is_positive = hn::Gt(top_lo, hn::Mul(top_hi, hn::Set(d, 0x1p-4F)));
    least = hn::IfThenElseZero(is_positive, nearest);
    most = hn::IfThenElse(is_bounded, farthest, hn::Set(d, infinity));
    if (is_reversed) {
        const V nearer = least;
        least = hn::Neg(most);
        most = hn::Neg(nearer);
    }
}

/// Depth is linear in the edge functions, which are raised.
HWY_INLINE void parallel_depth(const Drawn& t, const Edges& edges, V e1, V e2, V& least, V& most) {
    const D d;
    const double area = edges.is_flat ? std::abs(t.area) : edges.volume;
    const double inverse = 1 / area;
    const double b = t.p[1].depth - t.p[0].depth;
    const double c = t.p[2].depth - t.p[0].depth;
    const double change = std::abs(b) + std::abs(c);
    // find_side knows the area of a flat one to 2^-2 at worst: by its own bound.
    const double unsure = edges.is_flat ? t.area_error : edges.volume_error;
    const auto error = static_cast<float>(
        change * (2 * static_cast<double>(edges.bound) * inverse + 16 * 0x1p-24) *
            (1 + 2 * unsure) +
        change * 1.01 * unsure + 0x1p-22 * std::abs(t.p[0].depth) + 0x1p-48 * t.size + 0x1p-145
    );
    const V depth = hn::Add(
        hn::Set(d, static_cast<float>(t.p[0].depth)),
        hn::MulAdd(
            e1,
            hn::Set(d, static_cast<float>(b * inverse)),
            hn::Mul(e2, hn::Set(d, static_cast<float>(c * inverse)))
        )
    );
    least = hn::Sub(depth, hn::Set(d, error));
    most = hn::Add(depth, hn::Set(d, error));
}

/// Bounds of the depths at which rays meet the triangle, given its edge functions there, where they
/// may meet it at all and `edges.has_plane`.
template <bool is_radial>
HWY_INLINE void plane_depth(
    const Drawn& t,
    const Edges& edges,
    bool is_reversed,
    V e0,
    V e1,
    V e2,
    V& least,
    V& most
) {
    const D d;
    if constexpr (is_radial)
        radial_depth(t, edges, is_reversed, e0, e1, e2, least, most);
    else
        parallel_depth(t, edges, e1, e2, least, most);
    least = hn::Max(least, hn::Set(d, edges.depth_lo));
    most = hn::Min(most, hn::Set(d, edges.depth_hi));
}

} // namespace raywise::detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
