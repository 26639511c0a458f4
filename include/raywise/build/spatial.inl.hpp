// The body of build_spatial.
#pragma once

#include <raywise/build/binned.hpp>
#include <raywise/build/descent.hpp>
#include <raywise/build/node_metric.hpp>
#include <raywise/build/prim_box.hpp>
#include <raywise/build/slot_ranks.hpp>
#include <raywise/build/spatial.hpp>
#include <raywise/build/spatial_bins.hpp>
#include <raywise/build/spatial_split.hpp>
#include <raywise/build/split.hpp>
#include <raywise/build/top_down.hpp>
#include <raywise/build/tree_assembly.hpp>

#include <array>
#include <cstddef>
#include <mutex>
#include <optional>
#include <vector>

namespace raywise {

/// The recursion of build_spatial. A node's references stand at the begin of its slots; what is
/// behind them is its room for further ones.
template <HitMeasure M>
class SpatialBuild {
public:
    SpatialBuild(
        const TriangleView& triangles,
        const SpatialParams& params,
        const Executor& executor
    )
        : triangles_(triangles)
        , params_(params)
        , executor_(executor)
        , search_(params.binned, filter_) {}

    [[nodiscard]] Bvh build(const M& measure);

private:
    struct Task {
        PrimRange range;
        std::size_t limit = 0; ///< behind the last slot of the room
        std::size_t slot = 0;  ///< of the node
        int level = 0;
        Aabb box;
        NodeMass mass;

        [[nodiscard]] std::size_t room() const { return limit - range.last; }
    };

    struct Children {
        Task left;
        Task right;
    };

    [[nodiscard]] std::optional<Children>
    divide(const Task& task, const M& measure, const Executor& executor);

    template <class Measure>
    [[nodiscard]] std::optional<Children>
    halve(const Task& task, NodeMass mass, const Measure& metric, const Executor& executor);

    template <class Measure>
    [[nodiscard]] SpatialSplit find_cut(
        const Task& task,
        Metric which,
        const std::optional<Split>& split,
        const Measure& metric,
        const Executor& executor
    ) const;

    template <class Measure>
    [[nodiscard]] std::optional<Children> carry_out(
        const Task& task,
        const SpatialSplit& cut,
        const Measure& metric,
        const Executor& executor
    );

    /// Two tasks that share the room of their parent as they share its references.
    [[nodiscard]] Children
    share_out(const Task& task, std::size_t left_count, std::size_t right_count) const;

    const TriangleView& triangles_;
    const SpatialParams& params_;
    const Executor& executor_;
    AxisFilter<> filter_;
    BinnedSearch<AllAxes> search_;
    std::array<float, 3> root_mass_{}; ///< by metric
    std::optional<NodeRoom> nodes_;
    std::optional<LargeBuffer<Way>> ways_;
    std::vector<PrimId> slots_; ///< no_prim: unused
};

template <HitMeasure M>
Bvh SpatialBuild<M>::build(const M& measure) {
    const std::size_t count = triangles_.size();
    if (count == 0) return {};
    std::vector<Aabb> boxes(count);
    executor_.for_each_chunk(count, prim_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Triangle triangle = triangles_[to_prim(i)];
            // A minimum may overlook a NaN; the empty box is refused.
            const bool is_whole =
                is_finite(triangle.v0) && is_finite(triangle.v1) && is_finite(triangle.v2);
            boxes[i] = is_whole ? bounds(triangle) : Aabb{};
        }
    });
    const std::size_t room = room_for(count, params_.duplication);
    const PrimBoxes items = load_boxes(boxes, executor_, room);
    nodes_.emplace(count + room);
    ways_.emplace(count + room);
    slots_.assign(count + room, no_prim);

    Task root;
    root.range = {items.items.get(), items.spare.get(), 0, count, {}};
    root.range.centroids = bound_centroids(root.range, executor_);
    root.limit = count + room;
    root.box = to_aabb(bound_boxes(root.range, executor_));
    const auto& local = narrowed_to(measure, root.box);
    root.mass.mass = static_cast<float>(local(root.box));
    root_mass_ = {root.mass.mass, SurfaceMeasure{}(root.box), SideMeasure{}(root.box)};
    const Descent descent(*nodes_, executor_, [&](const auto&... args) { return divide(args...); });
    const NodeBlocks blocks = descent(root, local);
    return close_ranks(pack_nodes(*nodes_, blocks, executor_), slots_, executor_);
}

template <HitMeasure M>
auto SpatialBuild<M>::divide(const Task& task, const M& measure, const Executor& executor)
    -> std::optional<Children> {
    std::optional<Children> children;
    const NodeMass mass = visible_mass(task.box, task.mass);
    if (task.range.count() > 1 && task.level < params_.binned.max_depth)
        children = with_metric(mass.metric, measure, [&](const auto& metric) {
            return halve(task, mass, metric, executor);
        });
    if (!children) put_leaf(*nodes_, slots_, task);
    return children;
}

template <HitMeasure M>
template <class Measure>
auto SpatialBuild<M>::halve(
    const Task& task,
    NodeMass mass,
    const Measure& metric,
    const Executor& executor
) -> std::optional<Children> {
    const BinnedParams& limits = params_.binned;
    const std::size_t count = task.range.count();
    const std::optional<Split> split = search_(task.range, task.box, metric, executor);
    const SpatialSplit cut = find_cut(task, mass.metric, split, metric, executor);
    const bool is_cut = cut.left_count > 0 && (!split || cut.cost.sum < split->cost.sum);
    if (count <= limits.max_leaf_size) {
        const bool has_split = is_cut || split;
        const double sum = is_cut ? cut.cost.sum : split ? split->cost.sum : 0;
        if (!has_split || is_leaf_cheaper(limits.cost, count, sum, mass.mass)) return std::nullopt;
    }
    const std::size_t most = capacity(limits.max_leaf_size, limits.max_depth - (task.level + 1));
    const auto finish = [&](Children children, const Aabb& left, const Aabb& right) {
        children.left.box = left;
        children.right.box = right;
        children.left.mass = {mass.metric, static_cast<float>(metric(left))};
        children.right.mass = {mass.metric, static_cast<float>(metric(right))};
        return children;
    };
    if (is_cut && cut.cost.larger <= most) {
        if (auto children = carry_out(task, cut, metric, executor)) {
            if (std::max(children->left.range.count(), children->right.range.count()) <= most)
                return finish(*children, children->left.box, children->right.box);
        }
    }
    std::size_t left_count = count / 2;
    const bool is_by_plane = split && split->cost.larger <= most;
    if (is_by_plane) left_count = split->left_count;
    Children children = share_out(task, left_count, count - left_count);
    // Room between the halves: the right one does not start where the left one ends.
    PrimRange target = task.range;
    const std::size_t middle = children.right.range.first;
    CentroidBounds centroids;
    if (is_by_plane) {
        centroids = partition_stable(target, middle, split->is_left, executor);
    } else {
        const int axis = dominant_axis(to_vec(task.range.centroids.hi - task.range.centroids.lo));
        const MedianSplit median(task.range, task.range.first + left_count, axis);
        centroids = partition_stable(target, middle, median, executor);
    }
    children.left.range.centroids = centroids.left;
    children.right.range.centroids = centroids.right;
    if (is_by_plane) return finish(children, to_aabb(split->left), to_aabb(split->right));
    return finish(
        children,
        to_aabb(bound_boxes(children.left.range, executor)),
        to_aabb(bound_boxes(children.right.range, executor))
    );
}

template <HitMeasure M>
template <class Measure>
SpatialSplit SpatialBuild<M>::find_cut(
    const Task& task,
    Metric which,
    const std::optional<Split>& split,
    const Measure& metric,
    const Executor& executor
) const {
    SpatialSplit best;
    const std::size_t count = task.range.count();
    if (task.room() == 0 || count <= few_references) return best;
    if (split) {
        const Aabb common = intersect(to_aabb(split->left), to_aabb(split->right));
        const auto root = static_cast<double>(root_mass_[static_cast<std::size_t>(which)]);
        const auto shared = static_cast<double>(static_cast<float>(metric(common)));
        if (common.is_empty() || !(shared > params_.least_overlap * root)) return best;
        // Halves of a small node that share but a thin slice gain less than trying costs.
        const int axis = split->is_left.axis;
        if (count < small_node && common.size()[axis] < thin_slice * task.box.size()[axis])
            return best;
    }
    const SpatialGrid grid(task.box, bins_for(count, params_.spatial_bins));
    SpatialBins bins(grid.part_count());
    fill_bins(bins, task.range, triangles_, grid, executor);
    for (int axis = 0; axis < 3; ++axis)
        if (grid.can_cut(axis)) sweep_spatial(bins, grid, count, axis, metric, best);
    if (best.left_count == 0) return best;
    const std::size_t total = best.left_count + best.right_count;
    if (total > count + task.room()) return {};
    for (int part = 0; part < grid.part_count(); ++part)
        if (grid.plane(best.axis, part) >= best.plane) best.right.unite(bins.box(part, best.axis));
    return best;
}

template <HitMeasure M>
template <class Measure>
auto SpatialBuild<M>::carry_out(
    const Task& task,
    const SpatialSplit& cut,
    const Measure& metric,
    const Executor& executor
) -> std::optional<Children> {
    const PrimRange& range = task.range;
    const std::size_t count = range.count();
    const PrimBox* items = range.from + range.first;
    Way* ways = ways_->get() + range.first;
    const std::size_t chunk = executor.threads() == 1 ? count : prim_chunk;
    const std::size_t chunks = (count + chunk - 1) / chunk;
    std::vector<SpatialHalves> before(chunks + 1);
    executor.for_each_chunk(count, chunk, [&](std::size_t begin, std::size_t end) {
        before[begin / chunk + 1] =
            choose_ways(items + begin, end - begin, triangles_, cut, metric, ways + begin);
    });
    for (std::size_t c = 1; c < before.size(); ++c)
        before[c].unite(before[c - 1]);
    const std::size_t left_count = before.back().left_count;
    const std::size_t right_count = before.back().right_count;
    if (left_count == 0 || right_count == 0 || left_count + right_count > count + task.room())
        return std::nullopt;

    Children children = share_out(task, left_count, right_count);
    SpatialHalves halves;
    std::mutex merging;
    executor.for_each_chunk(count, chunk, [&](std::size_t begin, std::size_t end) {
        const SpatialHalves& at = before[begin / chunk];
        const SpatialHalves part = scatter_ways(
            items + begin,
            end - begin,
            triangles_,
            cut,
            ways + begin,
            range.to + children.left.range.first + at.left_count,
            range.to + children.right.range.first + at.right_count
        );
        const std::scoped_lock lock(merging);
        halves.unite(part);
    });
    children.left.range.centroids = halves.centroids.left;
    children.right.range.centroids = halves.centroids.right;
    children.left.box = to_aabb(halves.left);
    children.right.box = to_aabb(halves.right);
    return children;
}

template <HitMeasure M>
auto SpatialBuild<M>::share_out(const Task& task, std::size_t left_count, std::size_t right_count)
    const -> Children {
    const std::size_t total = left_count + right_count;
    const std::size_t room = task.limit - task.range.first - total;
    const std::size_t left_room = room * left_count / total;
    const std::size_t first = task.range.first;
    const std::size_t middle = first + left_count + left_room;
    Children children;
    children.left.range = task.range.arrived(first, first + left_count, {});
    children.left.limit = middle;
    children.left.level = task.level + 1;
    children.right.range = task.range.arrived(middle, middle + right_count, {});
    children.right.limit = task.limit;
    children.right.level = task.level + 1;
    return children;
}

template <HitMeasure M>
Bvh build_spatial(
    const TriangleView& triangles,
    const M& measure,
    const SpatialParams& params,
    const Executor& executor
) {
    check(params);
    return SpatialBuild<M>(triangles, params, executor).build(measure);
}

} // namespace raywise
