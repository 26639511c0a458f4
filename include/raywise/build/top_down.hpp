// The recursion that the three-axis builders share: find a split, compare with a leaf, divide, go
// on, in parallel, within a bounded depth.
#pragma once

#include <raywise/build/axis_policy.hpp>
#include <raywise/build/binned_params.hpp>
#include <raywise/build/bins.hpp>
#include <raywise/build/descent.hpp>
#include <raywise/build/node_metric.hpp>
#include <raywise/build/prim_box.hpp>
#include <raywise/build/split.hpp>
#include <raywise/build/tree_assembly.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace raywise {

/// What is known of the two halves of a node after a split was chosen.
struct Halves {
    std::size_t left_count = 0;
    CentroidBounds centroids;
    Aabb left;
    Aabb right;
    float left_mass = 0;
    float right_mass = 0;
};

/// Runs `sweep(axis)` on the axes that the filter lets through, and on the others when no split was
/// found there.
template <AxisPolicy P, class Sweep>
void try_axes(const AxisFilter<P>& filter, const Aabb& box, const Split& best, const Sweep& sweep) {
    const std::array<bool, 3> is_wanted = wanted_axes(filter, box);
    for (const bool wanted : {true, false}) {
        for (int axis = 0; axis < 3; ++axis)
            if (is_wanted[static_cast<std::size_t>(axis)] == wanted) sweep(axis);
        if (best.left_count > 0) return;
    }
}

/// Builds top down. `Search` answers search(range, box, measure, executor) with the best split, or
/// nothing where no plane separates.
template <HitMeasure M, class Search>
class TopDown {
public:
    TopDown(const BinnedParams& params, const Executor& executor, const Search& search)
        : params_(params), executor_(executor), search_(search) {}

    [[nodiscard]] Bvh build(std::span<const Aabb> boxes, const M& measure);

private:
    struct Task {
        PrimRange range;
        std::size_t slot = 0; ///< of the node in the room
        int level = 0;
        Aabb box;
        NodeMass mass;
    };

    struct Children {
        Task left;
        Task right;
    };

    [[nodiscard]] std::optional<Children>
    divide(const Task& task, const M& measure, const Executor& executor);

    template <class Measure>
    [[nodiscard]] std::optional<Halves>
    halve(const Task& task, NodeMass mass, const Measure& metric, const Executor& executor) const;

    const BinnedParams& params_;
    const Executor& executor_;
    const Search& search_;
    std::optional<NodeRoom> room_;
    std::vector<PrimId> prims_;
};

template <HitMeasure M, class Search>
Bvh TopDown<M, Search>::build(std::span<const Aabb> boxes, const M& measure) {
    if (boxes.empty()) return {};
    const PrimBoxes items = load_boxes(boxes, executor_);
    room_.emplace(boxes.size());
    prims_.resize(boxes.size());

    Task root;
    root.range = {items.items.get(), items.spare.get(), 0, boxes.size(), {}};
    root.range.centroids = bound_centroids(root.range, executor_);
    root.box = to_aabb(bound_boxes(root.range, executor_));
    const auto& local = narrowed_to(measure, root.box);
    root.mass.mass = static_cast<float>(local(root.box));
    const Descent descent(*room_, executor_, [&](const auto&... args) { return divide(args...); });
    const NodeBlocks blocks = descent(root, local);
    return {pack_nodes(*room_, blocks, executor_), std::move(prims_)};
}

template <HitMeasure M, class Search>
auto TopDown<M, Search>::divide(const Task& task, const M& measure, const Executor& executor)
    -> std::optional<Children> {
    std::optional<Halves> halves;
    const NodeMass mass = visible_mass(task.box, task.mass);
    if (task.range.count() > 1 && task.level < params_.max_depth)
        halves = with_metric(mass.metric, measure, [&](const auto& metric) {
            return halve(task, mass, metric, executor);
        });
    if (!halves) {
        put_leaf(*room_, prims_, task);
        return std::nullopt;
    }
    const std::size_t middle = task.range.first + halves->left_count;
    Children children;
    children.left.range = task.range.arrived(task.range.first, middle, halves->centroids.left);
    children.left.box = halves->left;
    children.left.mass = {mass.metric, halves->left_mass};
    children.left.level = task.level + 1;
    children.right.range = task.range.arrived(middle, task.range.last, halves->centroids.right);
    children.right.box = halves->right;
    children.right.mass = {mass.metric, halves->right_mass};
    children.right.level = task.level + 1;
    return children;
}

template <HitMeasure M, class Search>
template <class Measure>
std::optional<Halves> TopDown<M, Search>::halve(
    const Task& task,
    NodeMass mass,
    const Measure& metric,
    const Executor& executor
) const {
    const std::size_t count = task.range.count();
    const std::optional<Split> split = search_(task.range, task.box, metric, executor);
    if (count <= params_.max_leaf_size &&
        (!split || is_leaf_cheaper(params_.cost, count, split->cost.sum, mass.mass)))
        return std::nullopt;

    const int levels_left = params_.max_depth - (task.level + 1);
    // A lopsided split is refused where the levels left would not do for its larger child.
    if (split && split->cost.larger <= capacity(params_.max_leaf_size, levels_left)) {
        const std::size_t middle = task.range.first + split->left_count;
        const CentroidBounds centroids =
            partition_stable(task.range, middle, split->is_left, executor);
        return Halves{
            split->left_count,
            centroids,
            to_aabb(split->left),
            to_aabb(split->right),
            split->cost.left_mass,
            split->cost.right_mass
        };
    }
    const std::size_t left_count = count / 2;
    const std::size_t middle = task.range.first + left_count;
    const int axis = dominant_axis(to_vec(task.range.centroids.hi - task.range.centroids.lo));
    const CentroidBounds centroids =
        partition_stable(task.range, middle, MedianSplit(task.range, middle, axis), executor);
    const auto bound = [&](std::size_t begin, std::size_t end) {
        return to_aabb(bound_boxes(task.range.arrived(begin, end, {}), executor));
    };
    const Aabb left = bound(task.range.first, middle);
    const Aabb right = bound(middle, task.range.last);
    return Halves{
        left_count,
        centroids,
        left,
        right,
        static_cast<float>(metric(left)),
        static_cast<float>(metric(right))
    };
}

} // namespace raywise
