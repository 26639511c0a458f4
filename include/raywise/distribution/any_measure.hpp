// The closed set of measures that a run-time choice picks from, once, outside the loops.
#pragma once

#include <raywise/distribution/measured.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <variant>

namespace raywise {

/// One of the shipped measures. Builders are instantiated for each (src/toplevel).
using AnyMeasure = std::variant<SurfaceMeasure, ParallelMeasure, RadialMeasure, MeasuredMeasure>;

/// The measure of the box, whichever it is. For loops, visit once outside of them instead.
[[nodiscard]] inline float evaluate(const AnyMeasure& measure, const Aabb& box) {
    return std::visit([&box](const auto& m) { return static_cast<float>(m(box)); }, measure);
}

} // namespace raywise
