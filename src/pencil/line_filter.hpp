// A triangle against a ray of known axis, three edge functions at once. Included once for every
// instruction set. After [Woop13]; bounds as in ExactKernel::surely_misses.
#if defined(RAYWISE_PENCIL_LINE_FILTER) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_LINE_FILTER
#undef RAYWISE_PENCIL_LINE_FILTER
#else
#define RAYWISE_PENCIL_LINE_FILTER
#endif

#include <raywise/core/ids.hpp>

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A ray as the filter needs it: |direction along the axis| is about the largest.
struct Line {
    float origin_u, origin_v, origin_z;
    float shear_u, shear_v;       ///< direction u / z and v / z
    float least, greatest;        ///< t_min and t_max times |direction z|: |z - origin_z| of hits
    float slack;                  ///< absolute error of those, and of t when it is rounded
    float sign;                   ///< of direction z
    float doubt;                  ///< added to all error bounds; infinity: everything is in doubt
    std::size_t at_u, at_v, at_z; ///< floats into a record
};

enum class Finding : std::uint8_t { miss, hit, doubt };

/// What the filter found. Depth is along the ray, |direction z| times t, and within `error`.
struct Crossing {
    Finding finding;
    float depth;
    float error;
};

#if HWY_TARGET == HWY_SCALAR

/// Without vectors everything is in doubt, and exact arithmetic decides.
template <bool wanted_depth>
Crossing cross(const Line&, const float*) {
    return {Finding::doubt, 0, 0};
}

#else

using Lanes = hn::FixedTag<float, 4>;
using Vec = hn::Vec<Lanes>;

template <class V>
HWY_INLINE V turned(V v) {
    alignas(16) static constexpr std::int32_t next[4] = {1, 2, 0, 3};
    return hn::TableLookupLanes(v, hn::SetTableIndices(Lanes(), next));
}

template <class M>
HWY_INLINE unsigned first_three(M mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Lanes(), mask, bits);
    return bits[0] & 7U;
}

/// Whether the ray surely misses the triangle, surely hits its inside within [least, greatest], or
/// neither is sure. With wanted_depth, hits come with their depth.
///
/// An edge function of two vertices has the error bound of ExactKernel::surely_misses, taken over
/// the two. The depth of the hit is z = sum(e z) / sum(e) for the edge functions e, one sign all,
/// each within b, and depths within 2^-24 of themselves, at most m: its numerator is within
/// (3 b + 6 * 2^-24 S) m, its denominator within 3 b + 3 * 2^-24 S, S = |sum(e)|, so z is within
/// m (6 b / S + 12 * 2^-24) with the roundings of the quotient, second order terms left out;
/// 8 and 16 stand for 6 and 12, and b <= S / 64 is asked for.
template <bool wanted_depth>
HWY_INLINE Crossing cross(const Line& line, const float* record) {
    const Lanes d;
    const Vec z = hn::Sub(hn::LoadU(d, record + line.at_z), hn::Set(d, line.origin_z));
    const Vec x = hn::Sub(
        hn::Sub(hn::LoadU(d, record + line.at_u), hn::Set(d, line.origin_u)),
        hn::Mul(hn::Set(d, line.shear_u), z)
    );
    const Vec y = hn::Sub(
        hn::Sub(hn::LoadU(d, record + line.at_v), hn::Set(d, line.origin_v)),
        hn::Mul(hn::Set(d, line.shear_v), z)
    );
    // Lanes: a x b, b x c, c x a.
    const Vec edge = hn::Sub(hn::Mul(x, turned(y)), hn::Mul(y, turned(x)));
    const Vec wide = hn::Max(hn::Abs(x), hn::Abs(y));
    const Vec deep = hn::Abs(z);
    const Vec across = hn::Max(wide, turned(wide));
    const Vec size = hn::Add(across, hn::Max(deep, turned(deep)));
    const Vec bound = hn::Add(
        hn::Mul(
            size,
            hn::Add(
                hn::Mul(hn::Set(d, 24 * 0x1p-24F), across), hn::Mul(hn::Set(d, 48 * 0x1p-48F), size)
            )
        ),
        hn::Set(d, line.doubt)
    );
    const unsigned positive = first_three(hn::Gt(edge, bound));
    const unsigned negative = first_three(hn::Lt(edge, hn::Neg(bound)));
    if (positive != 0 && negative != 0) return {Finding::miss, 0, 0};

    const Vec along = hn::Mul(z, hn::Set(d, line.sign));
    // Roundings of z, of the limits and of t itself.
    constexpr float less = 1 - 0x1p-20F;
    constexpr float more = 1 + 0x1p-20F;
    const float tiny = line.slack;
    if (first_three(hn::Lt(along, hn::Set(d, line.least * less - tiny))) == 7 ||
        first_three(hn::Gt(along, hn::Set(d, line.greatest * more + tiny))) == 7)
        return {Finding::miss, 0, 0};
    if (positive != 7 && negative != 7) return {Finding::doubt, 0, 0};
    const float surely_least = line.least * more + tiny;
    const float surely_greatest = line.greatest * less - tiny;
    if constexpr (!wanted_depth) {
        if (first_three(hn::And(
                hn::Ge(along, hn::Set(d, surely_least)), hn::Le(along, hn::Set(d, surely_greatest))
            )) == 7)
            return {Finding::hit, 0, 0};
    }
    alignas(16) float e[4], f[4], b[4];
    hn::Store(edge, d, e);
    hn::Store(along, d, f);
    hn::Store(bound, d, b);
    const float sum = e[0] + e[1] + e[2];
    const float weight = std::abs(sum);
    const float most_wrong = std::max(std::max(b[0], b[1]), b[2]);
    if (!(most_wrong * 64 <= weight)) return {Finding::doubt, 0, 0};
    const float depth = (e[0] * f[2] + e[1] * f[0] + e[2] * f[1]) / sum;
    const float most = std::max(std::max(std::abs(f[0]), std::abs(f[1])), std::abs(f[2]));
    const float error = most * (8 * most_wrong / weight + 16 * 0x1p-24F) + tiny;
    if (depth - error >= surely_least && depth + error <= surely_greatest)
        return {Finding::hit, depth, error};
    if (depth + error < line.least * less - tiny || depth - error > line.greatest * more + tiny)
        return {Finding::miss, 0, 0};
    return {Finding::doubt, 0, 0};
}

#endif

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
