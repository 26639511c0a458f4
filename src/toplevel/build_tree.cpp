#include <raywise/toplevel/build_tree.hpp>

#include "build_with.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/measured.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/mixed_measure.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>

namespace raywise {
namespace {

using detail::build_with;
using detail::ChosenAxes;

constexpr std::size_t chunk = 8192;

void check(const Heuristic& heuristic) {
    if (!(heuristic.surface_share >= 0 && heuristic.surface_share < 1)) {
        throw Error("heuristic: surface_share must be in [0, 1)");
    }
    if (heuristic.counted_rays < 1 || heuristic.counted_rays > 100'000'000) {
        throw Error("heuristic: counted_rays must be in [1, 10^8]");
    }
    const float threshold = heuristic.axis_threshold.value_or(0.0F);
    if (!(threshold >= 0 && threshold <= 1)) {
        throw Error("heuristic: axis_threshold must be in [0, 1]");
    }
}

void put(BuildInput& input, std::size_t at, const Triangle& triangle) {
    input.boxes[at] = bounds(triangle);
    input.centroids[at] =
        to_float((to_double(triangle.v0) + to_double(triangle.v1) + to_double(triangle.v2)) / 3.0);
}

Aabb bounds_of(const BuildInput& input) {
    Aabb all;
    for (const Aabb& box : input.boxes)
        all = unite(all, box);
    return all;
}

/// Counts rays drawn from the distribution, shrunk toward the surface area by the heuristic's
/// share. A scene without surface area has nothing to shrink to: absent.
std::optional<MeasuredMeasure>
count_rays(const Aabb& root, const Distribution& distribution, const Heuristic& heuristic) {
    if (!(half_area(root) > 0)) return std::nullopt;
    MeasuredParams params;
    params.bounds = root;
    params.rays.reserve(heuristic.counted_rays);
    for (std::size_t i = 0; i < heuristic.counted_rays; ++i) {
        Rng rng(heuristic.counted_seed, i);
        params.rays.push_back({sample(distribution, rng), 1.0});
    }
    const auto total = static_cast<double>(heuristic.counted_rays);
    params.shrinkage = total * heuristic.surface_share / (1 - heuristic.surface_share);
    return MeasuredDistribution(std::move(params)).measure();
}

} // namespace

BuildInput build_input_of(const TriangleView& triangles, const Executor& executor) {
    BuildInput input;
    input.boxes.resize(triangles.size());
    input.centroids.resize(triangles.size());
    executor.for_each_chunk(triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            put(input, i, triangles[to_prim(i)]);
    });
    return input;
}

BuildInput build_input_of(
    const TriangleView& triangles,
    std::span<const PrimId> members,
    const Executor& executor
) {
    BuildInput input;
    input.boxes.resize(members.size());
    input.centroids.resize(members.size());
    executor.for_each_chunk(members.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            put(input, i, triangles[members[i]]);
    });
    return input;
}

BuiltTree build_tree(
    const BuildInput& input,
    const Distribution& distribution,
    const Heuristic& heuristic,
    const Executor& executor
) {
    check(heuristic);
    if (input.boxes.empty()) return {};
    const ChosenAxes axes{heuristic.axes, &distribution};
    const auto build = [&](const auto& measure) {
        return build_with(input, measure, axes, heuristic, executor);
    };
    switch (heuristic.measure) {
    case MeasureKind::surface:
        break;
    case MeasureKind::area:
        return std::visit(build, measure_of(distribution, heuristic.measure_mode));
    case MeasureKind::mixed:
        return std::visit(
            [&](const auto& measure) {
                using M = std::remove_cvref_t<decltype(measure)>;
                if constexpr (std::is_same_v<M, SurfaceMeasure>) {
                    return build(measure);
                } else {
                    return build(MixedMeasure(measure, bounds_of(input), heuristic.surface_share));
                }
            },
            measure_of(distribution, heuristic.measure_mode)
        );
    case MeasureKind::counted:
        if (const auto counted = count_rays(bounds_of(input), distribution, heuristic)) {
            return build(*counted);
        }
        break;
    }
    return build(SurfaceMeasure{});
}

BuiltTree
build_tree(const BuildInput& input, const Heuristic& heuristic, const Executor& executor) {
    check(heuristic);
    if (input.boxes.empty()) return {};
    const ChosenAxes axes{heuristic.axes, nullptr};
    return build_with(input, SurfaceMeasure{}, axes, heuristic, executor);
}

} // namespace raywise
