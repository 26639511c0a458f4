// `settle` for all rays of a group at once.
#if defined(RAYWISE_TRACE_SIMD_WIDE_GROUP_SETTLE) ==                                               \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_GROUP_SETTLE
#undef RAYWISE_TRACE_SIMD_WIDE_GROUP_SETTLE
#else
#define RAYWISE_TRACE_SIMD_WIDE_GROUP_SETTLE
#endif

#include "trace/simd/wide_group.inl.hpp"
#include "trace/simd/wide_lanes.inl.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/ray.hpp>

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// What is asked of each ray.
struct GroupQuestions {
    std::array<PerRay, 3> origin, direction;
    std::array<std::array<PerRay, 3>, 3> vertices; ///< of the triangle that is hit
    PerRay doubled_extent;
    PerRay most_t;  ///< t is not above
    PerRay largest; ///< magnitude of a component of the direction
};

struct GroupHits {
    PerRay t, u, v;
    std::uint32_t is_front = 0;   ///< bits: sum < 0
    std::uint32_t is_settled = 0; ///< bits: the others are for exact arithmetic
};

using Doubles = hn::CappedTag<double, 8>;
using DoubleLanes = hn::Vec<Doubles>;

struct DoubleVector {
    DoubleLanes x, y, z;
};

HWY_INLINE DoubleVector minus(const DoubleVector& a, const DoubleVector& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

// No fused operations: the weights are those of ExactKernel to the bit.

HWY_INLINE DoubleVector cross_of(const DoubleVector& a, const DoubleVector& b) {
    return {
        hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
        hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
        hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))
    };
}

HWY_INLINE DoubleLanes dot_of(const DoubleVector& a, const DoubleVector& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

/// The rays from `first` on, as many as there are doubles in a vector. See `settle`.
HWY_INLINE void settle_half(const GroupQuestions& asked, std::size_t first, GroupHits& out) {
    const Doubles d;
    const hn::Rebind<float, Doubles> df;
    const auto lanes = [&](const PerRay& numbers) HWY_ATTR {
        return hn::PromoteTo(d, hn::Load(df, numbers.items.data() + first));
    };
    const auto vector = [&](const std::array<PerRay, 3>& numbers) HWY_ATTR {
        return DoubleVector{lanes(numbers[0]), lanes(numbers[1]), lanes(numbers[2])};
    };
    const auto constant = [&](double value) HWY_ATTR { return hn::Set(d, value); };
    const DoubleVector direction = vector(asked.direction);
    const DoubleVector v0 = vector(asked.vertices[0]);
    const DoubleVector a = minus(v0, vector(asked.origin));
    const DoubleVector e1 = minus(vector(asked.vertices[1]), v0);
    const DoubleVector e2 = minus(vector(asked.vertices[2]), v0);
    const DoubleVector normal = cross_of(e1, e2);
    const DoubleVector moment = cross_of(a, direction);
    const auto v = dot_of(e2, moment);
    const auto w = hn::Neg(dot_of(e1, moment));
    const auto sum = dot_of(direction, normal);
    const auto volume = dot_of(a, normal);

    constexpr double unit = 72 * 0x1p-53, up = 1 + 0x1p-20;
    const auto slope = lanes(asked.largest);
    const auto most_t = lanes(asked.most_t);
    const auto half = hn::Mul(lanes(asked.doubled_extent), constant(0.5));
    const auto reach = hn::Mul(constant(unit * up), hn::MulAdd(most_t, slope, half));
    const auto area = hn::Mul(half, half);
    const auto sum_error = hn::Mul(hn::Mul(constant(unit * up), slope), area);
    const auto volume_error = hn::Mul(reach, area);
    const auto edge_error = hn::Mul(hn::Mul(reach, slope), hn::Mul(half, constant(up)));
    const auto least_sum = hn::Mul(hn::Abs(sum), constant(0x1p-26));
    const auto has_weights = hn::And(
        hn::Le(sum_error, hn::Mul(least_sum, constant(0x1p-5))), hn::Le(edge_error, least_sum)
    );

    const auto inverse = hn::Div(constant(1), sum);
    const auto t = hn::Mul(volume, inverse);
    const auto error = hn::MulAdd(
        hn::Mul(hn::MulAdd(most_t, sum_error, volume_error), hn::Abs(inverse)),
        constant(up),
        hn::Mul(constant(0x1p-50), most_t)
    );
    const auto low = hn::DemoteTo(df, hn::Sub(t, error));
    const auto high = hn::DemoteTo(df, hn::Add(t, error));
    const auto has_t =
        hn::And(hn::Eq(low, high), hn::Le(high, hn::Set(df, std::numeric_limits<float>::max())));
    const auto weight = [&](DoubleLanes part) HWY_ATTR {
        // In this order -0 stays, as std::clamp leaves it.
        return hn::DemoteTo(df, hn::Min(constant(1), hn::Max(constant(0), hn::Mul(part, inverse))));
    };
    hn::Store(hn::Add(low, hn::Zero(df)), df, out.t.items.data() + first);
    hn::Store(weight(v), df, out.u.items.data() + first);
    hn::Store(weight(w), df, out.v.items.data() + first);
    out.is_front |= bits_of(d, hn::Lt(sum, hn::Zero(d))) << first;
    out.is_settled |= (bits_of(d, has_weights) & bits_of(df, has_t)) << first;
}

HWY_INLINE void settle_group(const GroupQuestions& asked, GroupHits& out) {
    for (std::size_t first = 0; first < group_size; first += hn::MaxLanes(Doubles()))
        settle_half(asked, first, out);
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
