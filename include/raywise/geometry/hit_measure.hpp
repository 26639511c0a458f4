// The seam between ray distributions and builders: how much of the rays meets a box.
#pragma once

#include <raywise/geometry/aabb.hpp>

#include <concepts>

namespace raywise {

/// Share of the rays that meet a box. Only ratios matter. Finite, >= 0, monotone (a inside b =>
/// m(a) <= m(b)), 0 for an empty box.
template <class M>
concept HitMeasure = requires(const M& measure, const Aabb& box) {
    { measure(box) } -> std::convertible_to<float>;
};

/// A measure that can be restricted to the rays that meet a box; inside the box both give the same
/// mass. A builder narrows as it descends, so that counting recorded rays costs O(rays x depth) and
/// not O(rays x candidates).
template <class M>
concept NarrowableMeasure = HitMeasure<M> && requires(const M& measure, const Aabb& box) {
    { measure.narrowed(box) } -> std::same_as<M>;
};

/// The hit measure of uniform lines: proportional to the surface area. [Goldsmith87]
struct SurfaceMeasure {
    [[nodiscard]] constexpr float operator()(const Aabb& box) const { return half_area(box); }
};

static_assert(HitMeasure<SurfaceMeasure>);

} // namespace raywise
