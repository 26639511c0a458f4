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

// Roundings of depths, of the limits and of t itself.
inline constexpr float less = 1 - 0x1p-20F;
inline constexpr float more = 1 + 0x1p-20F;

#if HWY_TARGET == HWY_SCALAR

/// Without vectors everything is in doubt, and exact arithmetic decides.
inline Finding quick_cross(const Line&, const float*) {
    return Finding::doubt;
}

inline Crossing cross(const Line&, const float*) {
    return {Finding::doubt, 0, 0};
}

#else

/// Three vertices of a triangle; the last lane is anything.
using Lanes = hn::FixedTag<float, 4>;
using Vec = hn::Vec<Lanes>;

/// Lanes 1, 2, 0 and any.
HWY_INLINE Vec turned(Vec v) {
    alignas(16) static constexpr std::int32_t next[4] = {1, 2, 0, 3};
    return hn::TableLookupLanes(v, hn::SetTableIndices(Lanes(), next));
}

template <class M>
HWY_INLINE unsigned first_three(M mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Lanes(), mask, bits);
    return bits[0] & 7U;
}

/// Edge functions a x b, b x c, c x a, bounds of their errors, and depths along the ray.
struct Edges {
    Vec edge, bound, along;
};

/// The error of an edge function of two vertices: ExactKernel::surely_misses, taken over the two.
HWY_INLINE Edges edges(const Line& line, const float* record) {
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
    return {edge, bound, hn::Mul(z, hn::Set(d, line.sign))};
}

/// Whether the ray surely misses the triangle, surely hits its inside with all vertices within
/// [least, greatest], or neither is sure: then `cross` may know more.
HWY_INLINE Finding quick_cross(const Line& line, const float* record) {
    const Lanes d;
    const Edges e = edges(line, record);
    const unsigned positive = first_three(hn::Gt(e.edge, e.bound));
    const unsigned negative = first_three(hn::Lt(e.edge, hn::Neg(e.bound)));
    if (positive != 0 && negative != 0) return Finding::miss;
    const unsigned within = first_three(hn::And(
        hn::Ge(e.along, hn::Set(d, line.least * more + line.slack)),
        hn::Le(e.along, hn::Set(d, line.greatest * less - line.slack))
    ));
    return (positive | negative) == 7 && within == 7 ? Finding::hit : Finding::doubt;
}

/// Whether the ray surely misses the triangle, surely hits its inside within [least, greatest], or
/// neither is sure.
///
/// The depth of the hit is z = sum(e z) / sum(e) for the edge functions e, one sign all, each
/// within b, and depths within 2^-24 of themselves, at most m: its numerator is within (3 b + 6 *
/// 2^-24 S) m, its denominator within 3 b + 3 * 2^-24 S, S = |sum(e)|, so z is within m (6 b / S +
/// 12 * 2^-24) with the roundings of the quotient, second order terms left out; 8 and 16 stand for
/// 6 and 12, and b <= S / 64 is asked for.
HWY_INLINE Crossing cross(const Line& line, const float* record) {
    const Lanes d;
    const Edges edge = edges(line, record);
    const unsigned positive = first_three(hn::Gt(edge.edge, edge.bound));
    const unsigned negative = first_three(hn::Lt(edge.edge, hn::Neg(edge.bound)));
    if (positive != 0 && negative != 0) return {Finding::miss, 0, 0};
    alignas(16) float e[4], f[4], b[4];
    hn::Store(edge.edge, d, e);
    hn::Store(edge.along, d, f);
    hn::Store(edge.bound, d, b);
    const float least = std::min(std::min(f[0], f[1]), f[2]);
    const float greatest = std::max(std::max(f[0], f[1]), f[2]);
    if (greatest < line.least * less - line.slack || least > line.greatest * more + line.slack)
        return {Finding::miss, 0, 0};
    if (positive != 7 && negative != 7) return {Finding::doubt, 0, 0};
    const float sum = e[0] + e[1] + e[2];
    const float weight = std::abs(sum);
    const float most_wrong = std::max(std::max(b[0], b[1]), b[2]);
    if (!(most_wrong * 64 <= weight)) return {Finding::doubt, 0, 0};
    const float depth = (e[0] * f[2] + e[1] * f[0] + e[2] * f[1]) / sum;
    const float most = std::max(std::abs(least), std::abs(greatest));
    const float error = most * (8 * most_wrong / weight + 16 * 0x1p-24F) + line.slack;
    if (depth - error >= line.least * more + line.slack &&
        depth + error <= line.greatest * less - line.slack)
        return {Finding::hit, depth, error};
    if (depth + error < line.least * less - line.slack ||
        depth - error > line.greatest * more + line.slack)
        return {Finding::miss, 0, 0};
    return {Finding::doubt, 0, 0};
}

#endif

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
