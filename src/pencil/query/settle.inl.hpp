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

#include <limits>

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Vectors whose lanes are rays, or their triangles.
template <class D>
struct Points {
    hn::Vec<D> x, y, z;
};

template <class D>
HWY_INLINE Points<D> operator-(const Points<D>& a, const Points<D>& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

template <class D>
HWY_INLINE hn::Vec<D> dot(const Points<D>& a, const Points<D>& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

template <class D>
HWY_INLINE Points<D> cross(const Points<D>& a, const Points<D>& b) {
    return {
        hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
        hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
        hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))
    };
}

template <class D>
HWY_INLINE hn::Vec<D> largest_size(const Points<D>& a) {
    return hn::Max(hn::Max(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}

/// Hits of rays that pass through their triangles.
template <class D>
struct Settled {
    hn::Vec<hn::Rebind<float, D>> t, u, v;
    hn::Vec<D> sum;        ///< below zero where the back is met
    hn::Vec<D> is_settled; ///< 1, or 0 where t is too close to where floats round, or a weight not
                           ///< precise enough
};

/// By the very operations of ExactKernel::decide, and with the bounds derived there.
template <class D>
HWY_INLINE Settled<D> settle(
    D d,
    const Points<D>& origin,
    const Points<D>& direction,
    const Points<D>& v0,
    const Points<D>& v1,
    const Points<D>& v2
) {
    const Points<D> a = v0 - origin;
    const Points<D> e1 = v1 - v0;
    const Points<D> e2 = v2 - v0;
    const Points<D> normal = cross(e1, e2);
    const Points<D> moment = cross(a, direction);
    const auto sum = dot(direction, normal);
    const auto volume = dot(a, normal);

    constexpr double unit = 72 * 0x1p-53;
    const auto size_e1 = largest_size(e1);
    const auto size_e2 = largest_size(e2);
    const auto slope = largest_size(direction);
    const auto reach = hn::Mul(hn::Set(d, unit), largest_size(a));
    const auto face = hn::Mul(size_e1, size_e2);
    const auto sum_error = hn::Mul(hn::Mul(hn::Set(d, unit), slope), face);
    const auto volume_error = hn::Mul(reach, face);
    const auto edge_error = hn::Mul(hn::Mul(reach, slope), hn::Max(size_e1, size_e2));
    const auto least_sum = hn::Mul(hn::Abs(sum), hn::Set(d, 0x1p-26));

    const auto inverse = hn::Div(hn::Set(d, 1.0), sum);
    const auto t = hn::Mul(volume, inverse);
    const auto error = hn::Add(
        hn::Mul(
            hn::Mul(hn::Add(volume_error, hn::Mul(hn::Abs(t), sum_error)), hn::Abs(inverse)),
            hn::Set(d, 1 + 0x1p-20)
        ),
        hn::Mul(hn::Abs(t), hn::Set(d, 0x1p-50))
    );
    const hn::Rebind<float, D> floats;
    const auto low = hn::DemoteTo(floats, hn::Sub(t, error));
    const auto high = hn::DemoteTo(floats, hn::Add(t, error));
    const auto weight = [&](const Points<D>& edge) HWY_ATTR {
        const auto part = hn::Mul(dot(edge, moment), inverse);
        return hn::DemoteTo(floats, hn::Min(hn::Max(part, hn::Zero(d)), hn::Set(d, 1.0)));
    };
    const auto is_one = hn::Eq(hn::PromoteTo(d, low), hn::PromoteTo(d, high));
    const auto is_finite = hn::Le(
        hn::PromoteTo(d, high), hn::Set(d, static_cast<double>(std::numeric_limits<float>::max()))
    );
    const auto is_precise = hn::And(
        hn::Le(sum_error, hn::Mul(least_sum, hn::Set(d, 0x1p-5))), hn::Le(edge_error, least_sum)
    );
    const Points<D> minus_e1{hn::Neg(e1.x), hn::Neg(e1.y), hn::Neg(e1.z)};
    return {// Adding +0 turns -0 into +0.
            hn::Add(low, hn::Zero(floats)),
            weight(e2),
            weight(minus_e1),
            sum,
            hn::IfThenElseZero(hn::And(is_one, hn::And(is_finite, is_precise)), hn::Set(d, 1.0))
    };
}

/// Fills `hit` for a ray that passes through the triangle's inside, unless it cannot be settled.
HWY_INLINE bool settle(const Ray& ray, const Triangle& triangle, PrimId id, Hit& hit) {
    using D = hn::CappedTag<double, 1>;
    const D d;
    // Not by scalar conversions: g++ lets those wait for what was in a register before.
    const auto to_doubles = [&](float x) HWY_ATTR {
        return hn::PromoteTo(d, hn::Set(hn::Rebind<float, D>(), x));
    };
    const auto point = [&](const Vec3& p) HWY_ATTR {
        return Points<D>{to_doubles(p.x), to_doubles(p.y), to_doubles(p.z)};
    };
    const Settled<D> settled = settle(
        d,
        point(ray.origin),
        point(ray.direction),
        point(triangle.v0),
        point(triangle.v1),
        point(triangle.v2)
    );
    hit = {
        hn::GetLane(settled.t),
        hn::GetLane(settled.u),
        hn::GetLane(settled.v),
        id,
        hn::GetLane(settled.sum) < 0
    };
    return hn::GetLane(settled.is_settled) == 1;
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
