// The hit of a ray with a triangle that it is known to hit. Included once for every instruction
// set.
#if defined(RAYWISE_PENCIL_QUERY_SETTLE) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_QUERY_SETTLE
#undef RAYWISE_PENCIL_QUERY_SETTLE
#else
#define RAYWISE_PENCIL_QUERY_SETTLE
#endif

#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle.hpp>

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

/// Without vectors exact arithmetic decides all.
inline bool settle(const Ray&, const Triangle&, PrimId, Hit&) {
    return false;
}

#else

using Pair = hn::FixedTag<double, 2>;
using DoublePair = hn::Vec<Pair>;

/// Not by scalar conversions: g++ lets those wait for what was in a register before.
HWY_INLINE DoublePair pair_of(float first, float second) {
    const hn::FixedTag<float, 4> d;
    return hn::PromoteTo(Pair(), hn::LowerHalf(hn::OddEven(hn::Set(d, second), hn::Set(d, first))));
}

/// Fills `hit` for a ray that passes through the triangle's inside; false when t is too close to
/// where floats round, or the weights are not precise enough.
///
/// With a the first vertex as seen from the origin, e1 and e2 the edges from there and d the
/// direction: V = e2.(a x d), W = -e1.(a x d), U + V + W = d.(e1 x e2), t = a.(e1 x e2) / d.(e1 x
/// e2), by the very operations and with the bounds of ExactKernel::decide, two triple products at a
/// time.
HWY_INLINE bool settle(const Ray& ray, const Triangle& triangle, PrimId id, Hit& hit) {
    const Pair d;
    const auto is_first = hn::FirstN(d, 1);
    const Vec3 &v0 = triangle.v0, &v1 = triangle.v1, &v2 = triangle.v2;
    // A component of (e1, a) and of (e2, d).
    const auto edge_and_place = [&](float b, float a, float origin)
                                    HWY_ATTR { return hn::Sub(pair_of(b, a), pair_of(a, origin)); };
    const auto edge_and_direction = [&](float c, float a, float direction) HWY_ATTR {
        return hn::Sub(pair_of(c, direction), hn::IfThenElseZero(is_first, pair_of(a, a)));
    };
    const auto px = edge_and_place(v1.x, v0.x, ray.origin.x);
    const auto py = edge_and_place(v1.y, v0.y, ray.origin.y);
    const auto pz = edge_and_place(v1.z, v0.z, ray.origin.z);
    const auto qx = edge_and_direction(v2.x, v0.x, ray.direction.x);
    const auto qy = edge_and_direction(v2.y, v0.y, ray.direction.y);
    const auto qz = edge_and_direction(v2.z, v0.z, ray.direction.z);

    // (e1 x e2, a x d), and the other way round.
    const auto swapped = [&](DoublePair a, DoublePair b)
                             HWY_ATTR { return hn::Shuffle01(hn::Sub(a, b)); };
    const auto x = swapped(hn::Mul(py, qz), hn::Mul(pz, qy));
    const auto y = swapped(hn::Mul(pz, qx), hn::Mul(px, qz));
    const auto z = swapped(hn::Mul(px, qy), hn::Mul(py, qx));
    const auto v_and_sum = hn::Add(hn::Add(hn::Mul(qx, x), hn::Mul(qy, y)), hn::Mul(qz, z));
    const auto w_and_volume = hn::Add(hn::Add(hn::Mul(px, x), hn::Mul(py, y)), hn::Mul(pz, z));
    const auto second = [](DoublePair p) HWY_ATTR { return hn::GetLane(hn::Shuffle01(p)); };
    const double v = hn::GetLane(v_and_sum);
    const double sum = second(v_and_sum);
    const double w = -hn::GetLane(w_and_volume);
    const double volume = second(w_and_volume);

    const auto largest = [&](DoublePair a, DoublePair b, DoublePair c) HWY_ATTR {
        return hn::Max(hn::Max(hn::Abs(a), hn::Abs(b)), hn::Abs(c));
    };
    const auto sizes_p = largest(px, py, pz);
    const auto sizes_q = largest(qx, qy, qz);
    constexpr double unit = 72 * 0x1p-53;
    const double size_e1 = hn::GetLane(sizes_p);
    const double size_e2 = hn::GetLane(sizes_q);
    const double slope = second(sizes_q);
    const double reach = unit * second(sizes_p);
    const double face = size_e1 * size_e2;
    const double sum_error = unit * slope * face;
    const double volume_error = reach * face;
    const double edge_error = reach * slope * std::max(size_e1, size_e2);
    const double least_sum = std::abs(sum) * 0x1p-26;
    if (!(sum_error <= least_sum * 0x1p-5 && edge_error <= least_sum)) [[unlikely]]
        return false;

    const double inverse = 1 / sum;
    const double t = volume * inverse;
    const double error =
        (volume_error + std::abs(t) * sum_error) * std::abs(inverse) * (1 + 0x1p-20) +
        0x1p-50 * std::abs(t);
    const auto low = static_cast<float>(t - error);
    const auto high = static_cast<float>(t + error);
    if (low != high || !(high <= std::numeric_limits<float>::max())) [[unlikely]]
        return false;
    const auto weight = [&](double part) {
        return static_cast<float>(std::clamp(part * inverse, 0.0, 1.0));
    };
    // Adding +0 turns -0 into +0.
    hit = {low + 0.0F, weight(v), weight(w), id, sum < 0};
    return true;
}

#endif

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
