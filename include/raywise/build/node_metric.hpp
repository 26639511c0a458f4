// What a builder compares boxes by at one node: the measure, or a substitute where it sees nothing.
#pragma once

#include <raywise/build/quad.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <concepts>
#include <cstdint>

namespace raywise {

/// Sum of the sides: the last resort for boxes without surface, which are segments. Monotone.
struct SideMeasure {
    [[nodiscard]] constexpr float operator()(const Aabb& box) const {
        if (box.is_empty()) return 0;
        const Vec3 side = box.size();
        return side.x + side.y + side.z;
    }
};

/// The measure of a box that is not empty. Surface area is worth computing in the register: it is
/// what most builds spend their evaluations on.
template <HitMeasure M>
[[nodiscard]] float mass_of(const M& measure, const QuadBox& box) {
    if constexpr (std::same_as<M, SurfaceMeasure>) {
        const Quad side = box.hi - box.lo;
        const Quad turned = __builtin_shufflevector(side, side, 1, 2, 0, 3);
        const Quad faces = side * turned; // xy, yz, zx: the order of half_area, to the bit
        return faces[0] + faces[1] + faces[2];
    } else {
        return static_cast<float>(measure(to_aabb(box)));
    }
}

/// Which measure decides at a node. Measures are monotone, so what is blind at a node is blind
/// below it: the choice only ever advances on the way down.
enum class Metric : std::uint8_t { measure, surface, sides };

/// Calls `use` with the measure that `metric` names.
template <HitMeasure M, class Use>
decltype(auto) with_metric(Metric metric, const M& measure, Use&& use) {
    switch (metric) {
    case Metric::measure:
        return use(measure);
    case Metric::surface:
        return use(SurfaceMeasure{});
    case Metric::sides:
        break;
    }
    return use(SideMeasure{});
}

/// A metric and the mass it gives a node's box.
struct NodeMass {
    Metric metric = Metric::measure;
    float mass = 0;
};

/// The first metric from `known.metric` on that sees the box, and its mass; `known.mass` is taken
/// for the first one's. The mass is 0 only for a box that is a point.
[[nodiscard]] inline NodeMass visible_mass(const Aabb& box, NodeMass known) {
    if (known.mass > 0) return known;
    if (known.metric == Metric::measure) {
        known = {Metric::surface, SurfaceMeasure{}(box)};
        if (known.mass > 0) return known;
    }
    return {Metric::sides, SideMeasure{}(box)};
}

/// `measure` itself, or narrowed to the box if it can be.
template <HitMeasure M>
[[nodiscard]] decltype(auto) narrowed_to(const M& measure, const Aabb& box) {
    if constexpr (NarrowableMeasure<M>)
        return measure.narrowed(box);
    else
        return (measure);
}

} // namespace raywise
