#include <raywise/toplevel/build_wide.hpp>

#include <raywise/build/binned.hpp>
#include <raywise/build/binned_params.hpp>
#include <raywise/build/spatial.hpp>
#include <raywise/bvh/box_frame.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/mixed_measure.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_copy.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/optimize/collapse.hpp>
#include <raywise/optimize/reinsertion.hpp>
#include <raywise/toplevel/build_tree.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>
#include <variant>

namespace raywise {
namespace {

/// Any measure behind one call: a tree of high quality asks it rarely enough, and the builders are
/// compiled once for all.
struct SomeMeasure {
    FunctionRef<float(const Aabb&)> mass;

    [[nodiscard]] float operator()(const Aabb& box) const { return mass(box); }
};

/// The share of rays within a small angle of the frame's axis that meet a box of the frame: its
/// end, and as much of its sides as the mean slope shows.
struct AlongAxis {
    int axis;
    float mean_slope;

    [[nodiscard]] float operator()(const Aabb& box) const {
        if (box.is_empty()) return 0;
        const Vec3 size = box.size();
        const float u = size[(axis + 1) % 3];
        const float v = size[(axis + 2) % 3];
        return u * v + mean_slope * size[axis] * (u + v);
    }
};

/// Two triangles in a leaf at most: collapsing chooses which to join.
constexpr BinnedParams fine_leaves{.max_leaf_size = 2};

template <HitMeasure M>
Bvh build_binary(
    const TriangleView& triangles,
    const M& measure,
    TreeQuality quality,
    const Executor& executor
) {
    if (quality == TreeQuality::fast) {
        const BuildInput input = build_input_of(triangles, executor);
        return build_binned(input.boxes, measure, fine_leaves, executor);
    }
    const Bvh tree = build_spatial(triangles, measure, {.binned = fine_leaves}, executor);
    return reinsert(tree, measure, {}, executor);
}

template <HitMeasure M>
WideBvh build(
    const TriangleView& triangles,
    const M& measure,
    TreeQuality quality,
    const Executor& executor
) {
    return collapse(
        build_binary(triangles, measure, quality, executor), triangles, measure, {}, executor
    );
}

Aabb bounds_of(const TriangleView& triangles) {
    Aabb all;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        all = unite(all, bounds(triangles[to_prim(i)]));
    return all;
}

} // namespace

WideBvh build_wide(const TriangleView& triangles, TreeQuality quality, const Executor& executor) {
    return build(triangles, SurfaceMeasure{}, quality, executor);
}

WideBvh build_wide(
    const TriangleView& triangles,
    const Distribution& distribution,
    double surface_share,
    TreeQuality quality,
    const Executor& executor
) {
    if (!(surface_share >= 0 && surface_share < 1))
        throw Error("build_wide: surface_share must be in [0, 1)");
    return std::visit(
        [&](const auto& measure) {
            using M = std::remove_cvref_t<decltype(measure)>;
            if constexpr (std::is_same_v<M, SurfaceMeasure>) {
                return build(triangles, measure, quality, executor);
            } else {
                const MixedMeasure mixed(measure, bounds_of(triangles), surface_share);
                const auto mass = [&](const Aabb& box) { return static_cast<float>(mixed(box)); };
                return build(triangles, SomeMeasure{mass}, quality, executor);
            }
        },
        measure_of(distribution)
    );
}

WideBvh build_framed(
    const TriangleView& triangles,
    Vec3 direction,
    double cone_half_angle_deg,
    TreeQuality quality,
    const Executor& executor
) {
    if (!(cone_half_angle_deg >= 0 && cone_half_angle_deg <= 60))
        throw Error("build_framed: cone_half_angle_deg must be in [0, 60]");
    const BoxFrame frame = box_frame_along(to_double(direction));
    const TriangleCopy mesh = to_frame(triangles, frame, executor);
    // |cos| averages 2 / pi over the directions around the axis; a trace of the surface area keeps
    // boxes that stand along the axis from being free.
    const double slope = std::tan(cone_half_angle_deg * std::numbers::pi / 180);
    const AlongAxis along{frame.axis, static_cast<float>(slope * 2 / std::numbers::pi * 2 / 3)};
    const MixedMeasure measure(along, bounds_of(mesh.view()));
    WideBvh tree = collapse(
        build_binary(mesh.view(), measure, quality, executor), triangles, measure, {}, executor
    );
    tree.frame = frame;
    return tree;
}

} // namespace raywise
