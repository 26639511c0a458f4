// Where ray distributions and builders meet: a heuristic chosen at run time, and the tree it makes
// of boxes and a distribution. Pairs after [Falcone24]; the mix and the counted rays are ours.
#pragma once

#include <raywise/build/binned.hpp>
#include <raywise/build/guided.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace raywise {

/// How boxes are weighed.
enum class MeasureKind : std::uint8_t {
    surface, ///< SAH: uniform lines
    area,    ///< PAH: the hit measure of the distribution itself
    mixed,   ///< PAH with a grain of SAH, so that boxes that no ray meets are not free
    counted, ///< a sample of the distribution's rays, counted, with a grain of SAH
};

/// Which split axes are tried.
enum class AxisChoice : std::uint8_t {
    longest, ///< LSPH: the longest side of the box
    facing,  ///< SPFH: planes that contain the ray direction
    all,     ///< all three, in one metric
};

enum class BuilderKind : std::uint8_t {
    binned, ///< build_binned
    sweep,  ///< build_sweep: every plane
    guided, ///< build_guided: the thesis's decision tree
};

/// How a tree is built: a measure, an axis policy and a builder.
struct Heuristic {
    MeasureKind measure = MeasureKind::mixed;
    AxisChoice axes = AxisChoice::all;
    BuilderKind builder = BuilderKind::binned;
    double surface_share = 0.1;      ///< of SAH in `mixed` and `counted`, in [0, 1)
    std::size_t counted_rays = 4096; ///< drawn for `counted`, in [1, 10^8]
    std::uint64_t counted_seed = 1;  ///< of those rays
    /// Least quality of an axis that binned and sweep try, in [0, 1], unless no other can split;
    /// absent: 1 for longest, 0.4 for facing. The guided builder has guided.quality_threshold.
    std::optional<float> axis_threshold{};
    /// `thesis` for faithful runs of radial areas.
    MeasureMode measure_mode = MeasureMode::exact;
    BinnedParams binned{}; ///< of binned and sweep
    GuidedParams guided{}; ///< of guided
};

/// The strong baseline: surface area, all three axes, binned.
[[nodiscard]] inline Heuristic surface_area_heuristic() {
    Heuristic heuristic;
    heuristic.measure = MeasureKind::surface;
    return heuristic;
}

/// The primitives of a build: primitive i has boxes[i] and centroids[i].
struct BuildInput {
    std::vector<Aabb> boxes;
    std::vector<Vec3>
        centroids; ///< means of the three vertices; only the guided builder reads them
};

/// Boxes and centroids of all triangles. O(triangles).
[[nodiscard]] BuildInput
build_input_of(const TriangleView& triangles, const Executor& executor = serial_executor());

/// Boxes and centroids of the triangles listed in `members`, in their order.
[[nodiscard]] BuildInput build_input_of(
    const TriangleView& triangles,
    std::span<const PrimId> members,
    const Executor& executor = serial_executor()
);

struct BuiltTree {
    Bvh tree;            ///< its primitives are places in the input
    GuidedReport report; ///< of the guided builder; zero otherwise
};

/// Builds a tree for the distribution's rays. Over no boxes: an empty tree. Same bytes for any
/// executor; the guided builder is serial. Throws Error for parameters out of range and for boxes
/// that the builders refuse.
[[nodiscard]] BuiltTree build_tree(
    const BuildInput& input,
    const Distribution& distribution,
    const Heuristic& heuristic = {},
    const Executor& executor = serial_executor()
);

/// Builds a tree for uniform lines, whatever heuristic.measure says; no axis faces them, so
/// `facing` ranks all alike.
[[nodiscard]] BuiltTree build_tree(
    const BuildInput& input,
    const Heuristic& heuristic,
    const Executor& executor = serial_executor()
);

} // namespace raywise
