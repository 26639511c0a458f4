#include <raywise/toplevel/build_wide.hpp>

#include <raywise/build/binned.hpp>
#include <raywise/build/spatial.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/mixed_measure.hpp>
#include <raywise/optimize/collapse.hpp>
#include <raywise/optimize/reinsertion.hpp>
#include <raywise/toplevel/build_tree.hpp>

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

template <HitMeasure M>
WideBvh build(
    const TriangleView& triangles,
    const M& measure,
    TreeQuality quality,
    const Executor& executor
) {
    Bvh tree;
    if (quality == TreeQuality::high) {
        tree = build_spatial(triangles, measure, {}, executor);
        tree = reinsert(tree, measure, {}, executor);
    } else {
        tree = build_binned(build_input_of(triangles, executor).boxes, measure, {}, executor);
    }
    return collapse(tree, triangles, measure, {}, executor);
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

} // namespace raywise
