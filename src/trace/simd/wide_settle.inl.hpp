// The hit of a ray with a triangle that it is known to hit: what is left of ExactKernel::decide.
#if defined(RAYWISE_TRACE_SIMD_WIDE_SETTLE) ==                                                     \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_SETTLE
#undef RAYWISE_TRACE_SIMD_WIDE_SETTLE
#else
#define RAYWISE_TRACE_SIMD_WIDE_SETTLE
#endif

#include "trace/simd/wide_lanes.inl.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/ray.hpp>

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Pair = hn::FixedTag<double, 2>;
using DoublePair = hn::Vec<Pair>;

/// The first floats at two places.
HWY_INLINE DoublePair pair_of(const float* first, const float* second) {
    const hn::FixedTag<float, 4> d;
    const auto both = hn::InterleaveLower(d, hn::LoadU(d, first), hn::LoadU(d, second));
    return hn::PromoteTo(Pair(), hn::LowerHalf(both));
}

/// Fills `hit`; false when t is too close to where floats round, or the weights are not precise
/// enough. `most_t` is at least t, `largest` the largest component of the direction.
///
/// With a the first vertex as seen from the origin, e1 and e2 the edges from there and d the
/// direction: V = e2.(a x d), W = -e1.(a x d), U + V + W = d.(e1 x e2), t = a.(e1 x e2) / d.(e1 x
/// e2), by the very operations of ExactKernel::decide, two triple products at a time. The bounds of
/// their errors are the ones derived there, from larger numbers: edges have no component above half
/// the doubled extent h, and as the triangle is hit, a none above t * largest + h. So where they
/// suffice, those do, and u and v are the same.
HWY_INLINE bool settle(
    const Ray& ray,
    const TriangleBlock& block,
    std::size_t lane,
    float most_t,
    float largest,
    std::optional<Hit>& hit
) {
    const Pair d;
    const auto is_first = hn::FirstN(d, 1);
    const auto vertex = [&](std::size_t i, std::size_t axis) {
        constexpr std::size_t row = sizeof(block.vertices[0][0]);
        return floats_at(&block, (3 * i + axis) * row + lane * sizeof(float));
    };
    // A component of (e1, a) and of (e2, d).
    const auto edge_and_place = [&](std::size_t axis, const float* origin) HWY_ATTR {
        return hn::Sub(pair_of(vertex(1, axis), vertex(0, axis)), pair_of(vertex(0, axis), origin));
    };
    const auto edge_and_direction = [&](std::size_t axis, const float* direction) HWY_ATTR {
        const auto subtracted = pair_of(vertex(0, axis), vertex(0, axis));
        return hn::Sub(
            pair_of(vertex(2, axis), direction), hn::IfThenElseZero(is_first, subtracted)
        );
    };
    static_assert(
        offsetof(Ray, direction) + 6 * sizeof(float) <= sizeof(Ray), "reads four floats from z on"
    );
    const auto px = edge_and_place(0, &ray.origin.x), qx = edge_and_direction(0, &ray.direction.x);
    const auto py = edge_and_place(1, &ray.origin.y), qy = edge_and_direction(1, &ray.direction.y);
    const auto pz = edge_and_place(2, &ray.origin.z), qz = edge_and_direction(2, &ray.direction.z);

    // (e1 x e2, a x d), and the other way round.
    const auto swapped = [&](DoublePair a, DoublePair b)
                             HWY_ATTR { return hn::Shuffle01(hn::Sub(a, b)); };
    const auto x = swapped(hn::Mul(py, qz), hn::Mul(pz, qy));
    const auto y = swapped(hn::Mul(pz, qx), hn::Mul(px, qz));
    const auto z = swapped(hn::Mul(px, qy), hn::Mul(py, qx));
    const auto v_and_sum = hn::Add(hn::Add(hn::Mul(qx, x), hn::Mul(qy, y)), hn::Mul(qz, z));
    const auto w_and_volume = hn::Add(hn::Add(hn::Mul(px, x), hn::Mul(py, y)), hn::Mul(pz, z));
    const double v = hn::GetLane(v_and_sum), w = -hn::GetLane(w_and_volume);
    const double sum = hn::GetLane(hn::Shuffle01(v_and_sum));
    const double volume = hn::GetLane(hn::Shuffle01(w_and_volume));

    constexpr double unit = 72 * 0x1p-53, up = 1 + 0x1p-20;
    const double slope = static_cast<double>(largest);
    const double half = static_cast<double>(block.doubled_extents[lane]) / 2;
    const double reach = unit * up * (static_cast<double>(most_t) * slope + half);
    const double sum_error = unit * up * slope * half * half;
    const double volume_error = reach * half * half;
    const double edge_error = reach * slope * half * up;
    const double least_sum = std::abs(sum) * 0x1p-26;
    if (!(sum_error <= least_sum * 0x1p-5 && edge_error <= least_sum)) [[unlikely]]
        return false;

    const double inverse = 1 / sum;
    const double t = volume * inverse;
    const double error =
        (volume_error + static_cast<double>(most_t) * sum_error) * std::abs(inverse) * up +
        0x1p-50 * static_cast<double>(most_t);
    const auto low = static_cast<float>(t - error);
    const auto high = static_cast<float>(t + error);
    if (low != high || !(high <= std::numeric_limits<float>::max())) [[unlikely]]
        return false;
    const auto weight = [&](double part) {
        return static_cast<float>(std::clamp(part * inverse, 0.0, 1.0));
    };
    // Adding +0 turns -0 into +0.
    hit.emplace(Hit{low + 0.0F, weight(v), weight(w), block.prims[lane], sum < 0});
    return true;
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
