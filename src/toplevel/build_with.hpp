// The builders for one measure, behind a compiled boundary: each measure is instantiated in one
// file of its own.
#pragma once

#include <raywise/build/axis_policy.hpp>
#include <raywise/geometry/mixed_measure.hpp>
#include <raywise/toplevel/build_tree.hpp>

namespace raywise::detail {

/// The axis policy that a heuristic names, chosen per node: one ranking is nothing beside one
/// search for a plane, and one type keeps the instantiations few.
struct ChosenAxes {
    AxisChoice choice = AxisChoice::all;
    const Distribution* distribution = nullptr; ///< null: no direction to face

    [[nodiscard]] AxisRanking operator()(const Aabb& box) const {
        if (choice == AxisChoice::longest) return LongestAxis{}(box);
        if (choice == AxisChoice::all || distribution == nullptr) return AllAxes{}(box);
        return FacingAxis(SameDirection{direction_at(*distribution, box)})(box);
    }
};

template <HitMeasure M>
[[nodiscard]] BuiltTree build_with(
    const BuildInput& input,
    const M& measure,
    const ChosenAxes& axes,
    const Heuristic& heuristic,
    const Executor& executor
);

extern template BuiltTree
build_with(const BuildInput&, const SurfaceMeasure&, const ChosenAxes&, const Heuristic&, const Executor&);
extern template BuiltTree
build_with(const BuildInput&, const ParallelMeasure&, const ChosenAxes&, const Heuristic&, const Executor&);
extern template BuiltTree
build_with(const BuildInput&, const RadialMeasure&, const ChosenAxes&, const Heuristic&, const Executor&);
extern template BuiltTree
build_with(const BuildInput&, const MeasuredMeasure&, const ChosenAxes&, const Heuristic&, const Executor&);
extern template BuiltTree
build_with(const BuildInput&, const MixedMeasure<ParallelMeasure>&, const ChosenAxes&, const Heuristic&, const Executor&);
extern template BuiltTree
build_with(const BuildInput&, const MixedMeasure<RadialMeasure>&, const ChosenAxes&, const Heuristic&, const Executor&);
extern template BuiltTree
build_with(const BuildInput&, const MixedMeasure<MeasuredMeasure>&, const ChosenAxes&, const Heuristic&, const Executor&);

} // namespace raywise::detail
