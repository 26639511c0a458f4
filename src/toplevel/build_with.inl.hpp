// Body of build_with, see build_with.hpp.
#pragma once

#include "build_with.hpp"

#include <raywise/build/sweep.hpp>

namespace raywise::detail {

template <HitMeasure M>
BuiltTree build_with(
    const BuildInput& input,
    const M& measure,
    const ChosenAxes& axes,
    const Heuristic& heuristic,
    const Executor& executor
) {
    const float usual = axes.choice == AxisChoice::longest  ? 1.0F
                        : axes.choice == AxisChoice::facing ? 0.4F
                                                            : 0.0F;
    const AxisFilter<ChosenAxes> filter{axes, heuristic.axis_threshold.value_or(usual)};
    switch (heuristic.builder) {
    case BuilderKind::sweep:
        return {build_sweep(input.boxes, measure, heuristic.binned, executor, filter), {}};
    case BuilderKind::guided: {
        GuidedTree guided =
            build_guided(input.boxes, input.centroids, measure, axes, heuristic.guided);
        return {std::move(guided.tree), guided.report};
    }
    case BuilderKind::binned:
        break;
    }
    return {build_binned(input.boxes, measure, heuristic.binned, executor, filter), {}};
}

} // namespace raywise::detail
