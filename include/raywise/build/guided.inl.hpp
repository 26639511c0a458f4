// The body of build_guided.
#pragma once

#include <raywise/build/guided.hpp>
#include <raywise/build/node_metric.hpp>
#include <raywise/build/plane_scan.hpp>
#include <raywise/build/prim_box.hpp>
#include <raywise/build/split.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace raywise {

/// One run of the decision tree of section 4.5; the remarks G1 to G9 mark where faithful and
/// corrected mode part.
template <HitMeasure M, AxisPolicy P>
class GuidedBuild {
public:
    GuidedBuild(
        std::span<const Aabb> boxes,
        std::span<const Vec3> centroids,
        const M& measure,
        const P& policy,
        const GuidedParams& params
    )
        : boxes_(boxes)
        , centroids_(centroids)
        , measure_(measure)
        , policy_(policy)
        , params_(params) {}

    [[nodiscard]] GuidedTree run();

private:
    /// The largest float stands for "not known", as in the thesis's code.
    static constexpr double unknown = static_cast<double>(std::numeric_limits<float>::max());

    struct Task {
        std::size_t first = 0; ///< slots [first, last) of the primitives
        std::size_t last = 0;
        std::size_t node = 0;
        int level = 1; ///< the root's is 1
        double parent_probability = unknown;
    };

    struct Candidate {
        double cost = unknown;
        double left_probability = unknown;
        double right_probability = unknown;
        std::size_t larger = 0;
        int axis = -1; ///< -1: none
        float plane = 0;

        [[nodiscard]] bool exists() const { return axis >= 0; }

        /// Of the children's probabilities to the parent's.
        [[nodiscard]] double ratio(double parent) const {
            return exists() ? (left_probability + right_probability) / parent : unknown;
        }
    };

    /// How likely a ray meets a box, by one of the measures.
    struct Chance {
        Metric metric = Metric::measure;
        double total = 1;    ///< mass of all rays by the metric
        bool clamps = false; ///< to 1, as the thesis does
    };

    [[nodiscard]] double probability(const Aabb& box, const Chance& chance) const {
        const double mass = with_metric(chance.metric, measure_, [&](const auto& measure) {
            return static_cast<double>(static_cast<float>(measure(box)));
        });
        const double p = mass / chance.total;
        return chance.clamps && p > 1 ? 1 : p;
    }

    [[nodiscard]] Aabb bound(std::size_t first, std::size_t last) const;
    [[nodiscard]] std::span<const PrimId> prims(const Task& task) const {
        return std::span(prims_).subspan(task.first, task.last - task.first);
    }

    [[nodiscard]] Chance chance_at(const Aabb& box, int level) const;
    [[nodiscard]] bool is_measured(int level) const { return level <= params_.max_measured_levels; }

    void split(const Task& task);
    [[nodiscard]] Candidate
    search(const Task& task, const Aabb& box, const Chance& chance, double parent);
    void
    try_axis(const Task& task, const Aabb& box, int axis, const Chance& chance, Candidate& best);
    [[nodiscard]] std::vector<float> planes_on(const Task& task, const Aabb& box, int axis) const;
    [[nodiscard]] bool is_leaf_cheaper(std::size_t count, const Candidate& best, double own) const;
    [[nodiscard]] std::size_t divide(const Task& task, const Candidate& best);
    [[nodiscard]] std::size_t halve(const Task& task);
    [[nodiscard]] bool is_stopped(const Task& child, const Aabb& box);
    void put_leaf(const Task& task, const Aabb& box);

    std::span<const Aabb> boxes_;
    std::span<const Vec3> centroids_;
    const M& measure_;
    const P& policy_;
    const GuidedParams& params_;
    Chance measured_; ///< by the measure
    Chance surface_;  ///< by surface area, of the root's
    std::vector<PrimId> prims_;
    std::vector<Node> nodes_;
    GuidedReport report_;
};

template <HitMeasure M, AxisPolicy P>
GuidedTree GuidedBuild<M, P>::run() {
    if (boxes_.empty()) return {};
    prims_.resize(boxes_.size());
    for (std::size_t i = 0; i < prims_.size(); ++i)
        prims_[i] = to_prim(i);
    const Aabb box = bound(0, prims_.size());
    const auto root_mass = static_cast<double>(static_cast<float>(measure_(box)));
    const double total = params_.total_mass.value_or(root_mass > 0 ? root_mass : 1);
    measured_ = {Metric::measure, total, params_.faithful};
    surface_ = {Metric::surface, static_cast<double>(half_area(box)), params_.faithful};

    nodes_.emplace_back();
    Task root{.last = prims_.size()};
    split(root);
    return {{std::move(nodes_), std::move(prims_)}, report_};
}

template <HitMeasure M, AxisPolicy P>
auto GuidedBuild<M, P>::chance_at(const Aabb& box, int level) const -> Chance {
    if (params_.faithful) {
        if (is_measured(level)) return measured_;
        // G9: surface area over the mass of the rays.
        return {Metric::surface, measured_.total, true};
    }
    // G4: where the measure sees nothing, something else decides.
    const bool is_own = is_measured(level) && probability(box, measured_) > 0;
    if (is_own) return measured_;
    if (half_area(box) > 0) return surface_;
    return {Metric::sides, 1, false};
}

template <HitMeasure M, AxisPolicy P>
void GuidedBuild<M, P>::split(const Task& task) {
    const Aabb box = bound(task.first, task.last);
    const std::size_t count = task.last - task.first;
    const int depth = task.level - 1;
    const Chance chance = chance_at(box, task.level);
    // G1, G3, G5: corrected, a node's own probability is always known and by the metric in use.
    const double own = params_.faithful ? task.parent_probability : probability(box, chance);
    if (depth >= Bvh::max_depth || (!params_.faithful && count == 1)) return put_leaf(task, box);

    const Candidate best = search(task, box, chance, own);
    if (params_.faithful && !best.exists()) return put_leaf(task, box); // G6
    if (!params_.faithful && is_leaf_cheaper(count, best, own)) return put_leaf(task, box);
    const bool fits =
        best.exists() &&
        (params_.faithful ||
         best.larger <= capacity(params_.max_leaf_size, Bvh::max_depth - (depth + 1)));
    const std::size_t middle = fits ? divide(task, best) : halve(task);

    ++report_.inner_nodes;
    const std::size_t pair = nodes_.size();
    nodes_.resize(pair + 2);
    nodes_[task.node] = Node::inner(box, to_node(pair));
    const Task left{task.first, middle, pair, task.level + 1, best.left_probability};
    const Task right{middle, task.last, pair + 1, task.level + 1, best.right_probability};
    for (const Task& child : {left, right}) {
        const Aabb child_box = bound(child.first, child.last);
        if (is_stopped(child, child_box))
            put_leaf(child, child_box);
        else
            split(child);
    }
}

template <HitMeasure M, AxisPolicy P>
auto GuidedBuild<M, P>::search(
    const Task& task,
    const Aabb& box,
    const Chance& chance,
    double parent
) -> Candidate {
    Candidate best;
    int previous = -1;
    const AxisRanking ranking = is_measured(task.level) ? policy_(box) : LongestAxis{}(box);
    for (const RankedAxis& ranked : ranking) {
        if (best.ratio(parent) <= params_.excellent_ratio) break;
        if (ranked.quality >= params_.quality_threshold) {
            try_axis(task, box, ranked.axis, chance, best);
            previous = ranked.axis;
            continue;
        }
        if (best.ratio(parent) <= params_.acceptable_ratio) break;
        const AxisRanking longest = LongestAxis{}(box);
        const int axis = longest[0].axis == previous ? longest[1].axis : longest[0].axis;
        ++report_.forced_fallbacks;
        if (params_.faithful) {
            // G2: what was found is forgotten, its place is not (G5).
            best.cost = best.left_probability = best.right_probability = unknown;
            try_axis(task, box, axis, surface_, best);
        } else {
            try_axis(task, box, axis, chance, best);
        }
        break;
    }
    return best;
}

template <HitMeasure M, AxisPolicy P>
void GuidedBuild<M, P>::try_axis(
    const Task& task,
    const Aabb& box,
    int axis,
    const Chance& chance,
    Candidate& best
) {
    ++report_.axes_tried;
    const std::vector<float> planes = planes_on(task, box, axis);
    const PlaneScan scan(prims(task), boxes_, centroids_, axis, planes);
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const Half& left = scan.left(i);
        const Half& right = scan.right(i);
        if (left.count == 0 || right.count == 0) continue;
        // Corrected: an empty slab brings no new plane.
        if (!params_.faithful && i > 0 && scan.left(i - 1).count == left.count) continue;
        report_.cost_evaluations += 2;
        const double left_p = probability(left.box, chance);
        const double right_p = probability(right.box, chance);
        const double cost = params_.cost.prim * (left_p * static_cast<double>(left.count) +
                                                 right_p * static_cast<double>(right.count));
        const std::size_t larger = std::max(left.count, right.count);
        // G7: corrected, ties go to the more balanced split.
        const bool wins_tie = !params_.faithful && cost == best.cost && larger < best.larger;
        if (cost < best.cost || wins_tie) best = {cost, left_p, right_p, larger, axis, planes[i]};
    }
}

template <HitMeasure M, AxisPolicy P>
std::vector<float> GuidedBuild<M, P>::planes_on(const Task& task, const Aabb& box, int axis) const {
    // G6, G8: planes over the node's box, the last one left out.
    if (params_.faithful)
        return place_planes(box.lo[axis], box.hi[axis], params_.bin_count, params_.bin_count - 2);
    Aabb bounds;
    for (const PrimId prim : prims(task))
        bounds = unite(bounds, centroids_[to_index(prim)]);
    return place_planes(bounds.lo[axis], bounds.hi[axis], params_.bin_count, params_.bin_count - 1);
}

template <HitMeasure M, AxisPolicy P>
bool GuidedBuild<M, P>::is_leaf_cheaper(std::size_t count, const Candidate& best, double own)
    const {
    if (count > params_.max_leaf_size) return false;
    if (!best.exists()) return true;
    return !(
        2 * params_.cost.node + best.cost / own < params_.cost.prim * static_cast<double>(count)
    );
}

template <HitMeasure M, AxisPolicy P>
std::size_t GuidedBuild<M, P>::divide(const Task& task, const Candidate& best) {
    std::vector<PrimId> right;
    std::size_t middle = task.first;
    for (std::size_t slot = task.first; slot < task.last; ++slot) {
        const PrimId prim = prims_[slot];
        if (centroids_[to_index(prim)][best.axis] < best.plane)
            prims_[middle++] = prim;
        else
            right.push_back(prim);
    }
    std::copy(right.begin(), right.end(), prims_.begin() + static_cast<std::ptrdiff_t>(middle));
    return middle;
}

/// The median of the centroids on their longest axis, ties by id.
template <HitMeasure M, AxisPolicy P>
std::size_t GuidedBuild<M, P>::halve(const Task& task) {
    Aabb bounds;
    for (const PrimId prim : prims(task))
        bounds = unite(bounds, centroids_[to_index(prim)]);
    const int axis = dominant_axis(bounds.size());
    const auto at = [&](std::size_t slot) {
        return prims_.begin() + static_cast<std::ptrdiff_t>(slot);
    };
    const std::size_t middle = task.first + (task.last - task.first) / 2;
    std::sort(at(task.first), at(task.last), [&](PrimId a, PrimId b) {
        const float x = centroids_[to_index(a)][axis];
        const float y = centroids_[to_index(b)][axis];
        return x < y || (x == y && a < b);
    });
    return middle;
}

template <HitMeasure M, AxisPolicy P>
bool GuidedBuild<M, P>::is_stopped(const Task& child, const Aabb& box) {
    ++report_.stop_checks;
    const std::size_t count = child.last - child.first;
    const double p = probability(box, chance_at(box, child.level));
    return child.level > params_.max_levels ||
           p * static_cast<double>(count) * params_.cost.prim < params_.max_leaf_cost ||
           p < params_.max_leaf_probability ||
           2 * static_cast<double>(half_area(box)) < params_.max_leaf_area ||
           (params_.faithful && count < params_.max_leaf_size);
}

template <HitMeasure M, AxisPolicy P>
Aabb GuidedBuild<M, P>::bound(std::size_t first, std::size_t last) const {
    Aabb box;
    for (std::size_t slot = first; slot < last; ++slot)
        box = unite(box, boxes_[to_index(prims_[slot])]);
    return box;
}

template <HitMeasure M, AxisPolicy P>
void GuidedBuild<M, P>::put_leaf(const Task& task, const Aabb& box) {
    nodes_[task.node] = Node::leaf(
        box,
        static_cast<std::uint32_t>(task.first),
        static_cast<std::uint32_t>(task.last - task.first)
    );
}

template <HitMeasure M, AxisPolicy P>
GuidedTree build_guided(
    std::span<const Aabb> boxes,
    std::span<const Vec3> centroids,
    const M& measure,
    const P& policy,
    const GuidedParams& params
) {
    check(params);
    check_boxes(boxes);
    if (centroids.size() != boxes.size()) throw Error("there must be one centroid per box");
    if (!std::all_of(centroids.begin(), centroids.end(), [](Vec3 c) { return is_finite(c); }))
        throw Error("a centroid is not finite");
    return GuidedBuild<M, P>(boxes, centroids, measure, policy, params).run();
}

} // namespace raywise
