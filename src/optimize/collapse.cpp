#include <raywise/optimize/collapse.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/large_buffer.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/optimize/child_order.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace raywise {

void check(const CollapseParams& params) {
    if (!(params.block_cost > 0) || !std::isfinite(params.block_cost))
        throw Error("collapse: block_cost must be finite and > 0");
    if (params.max_leaf_size < 1 || params.max_leaf_size > 64)
        throw Error("collapse: max_leaf_size must be in [1, 64]");
}

namespace detail {
namespace {

constexpr std::size_t width = WideNode::width;

/// The cheapest ways to stand for one binary node and all below it.
struct Plan {
    std::array<float, width> cost; ///< [k]: as at most k + 1 slots of the node above
    std::uint32_t prims;
    bool as_leaf; ///< when it is one slot: a leaf is cheapest
};

/// Plans from the leaves up, as [Ylitie17] does.
class Planner {
public:
    Planner(
        const Bvh& tree,
        const NodeWeights& weights,
        const CollapseParams& params,
        const Executor& executor
    )
        : tree_(tree), weights_(weights), params_(params), plans_(tree.nodes.size()) {
        if (tree.is_empty()) return;
        // Subtrees first, side by side, then what is above them.
        constexpr std::size_t many = 64;
        std::vector<NodeId> above;
        std::vector<NodeId> tops{NodeId{0}};
        for (std::size_t i = 0; i < tops.size() && tops.size() - i < many; ++i) {
            above.push_back(tops[i]);
            if (tree[tops[i]].is_leaf()) continue;
            const NodeId left = tree[tops[i]].left();
            const NodeId right = tree[tops[i]].right();
            tops.push_back(left);
            tops.push_back(right);
        }
        const std::size_t first = above.size();
        executor.for_each_chunk(tops.size() - first, 1, [&](std::size_t begin, std::size_t) {
            plan_all(tops[first + begin]);
        });
        for (std::size_t i = first; i-- > 0;)
            plan(to_index(above[i]));
    }

    [[nodiscard]] const Plan& operator[](NodeId id) const { return plans_[to_index(id)]; }

    [[nodiscard]] float weight(NodeId id) const { return weights_.mass[to_index(id)]; }

    /// The slots that a wide node made of `id` has, by rising promise; equal ones left to right.
    struct Slots {
        std::array<NodeId, width> ids{};
        std::size_t count = 0;
    };

    [[nodiscard]] Slots slots_of(NodeId id) const {
        Slots slots;
        if ((*this)[id].as_leaf) // only the root: a leaf needs a node above
            slots.ids[slots.count++] = id;
        else
            share(id, width, slots);
        NodeId* const first = slots.ids.data();
        // By insertion: stable, and eight slots at most.
        for (NodeId* next = first; next != first + slots.count; ++next) {
            const auto is_less = [&](NodeId a, NodeId b) { return promise(a) < promise(b); };
            std::rotate(std::upper_bound(first, next, *next, is_less), next, next + 1);
        }
        return slots;
    }

private:
    /// Hits found per cost, for any-hit rays that meet the box.
    [[nodiscard]] double promise(NodeId id) const {
        const NodeOutlook& outlook = weights_.outlook[to_index(id)];
        return outlook.opacity / outlook.cost;
    }

    void plan_all(NodeId id) { // NOLINT(misc-no-recursion): as deep as the tree, at most 64
        const Node& node = tree_[id];
        if (!node.is_leaf()) {
            plan_all(node.left());
            plan_all(node.right());
        }
        plan(to_index(id));
    }

    void look_out(std::size_t at, const Node& node) const {
        const std::size_t left = to_index(node.left());
        const std::size_t right = to_index(node.right());
        weights_.outlook[at] = outlook_in_order(
            weights_.outlook[left],
            share_of(weights_.mass[left], weights_.mass[at]),
            weights_.outlook[right],
            share_of(weights_.mass[right], weights_.mass[at]),
            {}
        );
    }

    /// The least cost of sharing k slots among the children; at how many for the left one.
    struct Share {
        float cost = std::numeric_limits<float>::infinity();
        std::size_t left = 1;
    };

    [[nodiscard]] Share best_share(const Node& node, std::size_t k) const {
        const Plan& left = plans_[to_index(node.left())];
        const Plan& right = plans_[to_index(node.right())];
        Share best;
        for (std::size_t i = 1; i < k; ++i) {
            const float cost = left.cost[i - 1] + right.cost[k - i - 1];
            if (cost < best.cost) best = {cost, i};
        }
        return best;
    }

    void plan(std::size_t at) {
        const Node& node = tree_.nodes[at];
        Plan& plan = plans_[at];
        if (node.is_leaf()) {
            plan.prims = static_cast<std::uint32_t>(node.count());
            plan.as_leaf = true;
            plan.cost.fill(leaf_cost(at, plan.prims));
            return;
        }
        look_out(at, node);
        plan.prims = plans_[to_index(node.left())].prims + plans_[to_index(node.right())].prims;
        for (std::size_t k = 2; k <= width; ++k)
            plan.cost[k - 1] = best_share(node, k).cost;
        const float as_node = weights_.mass[at] + plan.cost[width - 1];
        const float as_leaf = plan.prims <= params_.max_leaf_size
                                  ? leaf_cost(at, plan.prims)
                                  : std::numeric_limits<float>::infinity();
        plan.as_leaf = as_leaf <= as_node;
        plan.cost[0] = std::min(as_leaf, as_node);
        for (std::size_t k = 1; k < width; ++k)
            plan.cost[k] = std::min(plan.cost[k], plan.cost[k - 1]);
    }

    [[nodiscard]] float leaf_cost(std::size_t at, std::uint32_t prims) const {
        constexpr auto lanes = static_cast<std::uint32_t>(TriangleBlock::width);
        const std::uint32_t blocks = (prims + lanes - 1) / lanes;
        return weights_.mass[at] * static_cast<float>(params_.block_cost) *
               static_cast<float>(blocks);
    }

    /// Puts into `slots` what stands for inner node `id` when it has k >= 2 slots and must use
    /// more than one.
    void share(NodeId id, std::size_t k, Slots& slots) const {
        const Node& node = tree_[id];
        const std::size_t left = best_share(node, k).left;
        fill(node.left(), left, slots);
        fill(node.right(), k - left, slots);
    }

    void fill(NodeId id, std::size_t k, Slots& slots) const {
        const Plan& plan = plans_[to_index(id)];
        while (k > 1 && plan.cost[k - 2] <= plan.cost[k - 1])
            --k;
        if (k == 1)
            slots.ids[slots.count++] = id;
        else
            share(id, k, slots);
    }

    const Bvh& tree_;
    const NodeWeights& weights_;
    const CollapseParams& params_;
    LargeBuffer<Plan> plans_;
};

/// Writes what was planned, depth first: the nodes in one thread, the triangles in all.
class Writer {
public:
    Writer(const Bvh& tree, const TriangleView& triangles, const Planner& plans)
        : tree_(tree), triangles_(triangles), plans_(plans) {}

    [[nodiscard]] WideBvh write(const Executor& executor) {
        if (tree_.is_empty()) return {};
        out_.box = tree_.root().box();
        write_node(NodeId{0});
        fill_blocks(executor);
        return std::move(out_);
    }

private:
    /// A block before its triangles are fetched.
    struct Listed {
        std::array<PrimId, TriangleBlock::width> prims;
        std::uint32_t is_last;
    };

    std::size_t write_node(NodeId id) {
        const Planner::Slots slots = plans_.slots_of(id);
        const std::size_t at = out_.nodes.size();
        if (at >= WideRef::max_nodes) throw Error("collapse: too many nodes");
        out_.nodes.emplace_back(WideNode{});
        for (std::size_t i = 0; i < width; ++i) {
            if (i >= slots.count) {
                out_.nodes[at].clear(i);
                continue;
            }
            const NodeId child = slots.ids[i];
            const WideRef ref = plans_[child].as_leaf ? WideRef::leaf(list_leaf(child))
                                                      : WideRef::node(write_node(child));
            out_.nodes[at].set(i, tree_[child].box(), ref);
        }
        return at;
    }

    std::size_t list_leaf(NodeId id) {
        prims_.clear();
        gather(id);
        // A spatial split may have put a triangle into several of the nodes that became one leaf.
        std::sort(prims_.begin(), prims_.end());
        prims_.erase(std::unique(prims_.begin(), prims_.end()), prims_.end());
        const std::size_t first = listed_.size();
        for (std::size_t i = 0; i < prims_.size(); i += TriangleBlock::width) {
            if (listed_.size() >= WideRef::max_blocks) throw Error("collapse: too many triangles");
            Listed& block = listed_.emplace_back();
            block.is_last = i + TriangleBlock::width >= prims_.size() ? 1 : 0;
            for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane)
                block.prims[lane] = i + lane < prims_.size() ? prims_[i + lane] : no_prim;
        }
        return first;
    }

    void gather(NodeId id) {
        const Node& node = tree_[id];
        if (!node.is_leaf()) {
            gather(node.left());
            gather(node.right());
            return;
        }
        for (const PrimId prim : tree_.prims_of(node))
            prims_.push_back(prim);
    }

    void fill_blocks(const Executor& executor) {
        constexpr std::size_t chunk = 1024;
        out_.blocks.resize(listed_.size());
        std::vector<Aabb> bounds_of_chunks((listed_.size() + chunk - 1) / chunk);
        executor.for_each_chunk(listed_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            Aabb& box = bounds_of_chunks[begin / chunk];
            for (std::size_t i = begin; i < end; ++i)
                box = unite(box, fill_block(i));
        });
        for (const Aabb& box : bounds_of_chunks)
            out_.vertex_bounds = unite(out_.vertex_bounds, box);
    }

    /// Returns the bounds of its triangles.
    [[nodiscard]] Aabb fill_block(std::size_t i) {
        Aabb box;
        TriangleBlock& block = out_.blocks[i];
        block.is_last = listed_[i].is_last;
        block.unused = {};
        for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane) {
            const PrimId prim = listed_[i].prims[lane];
            if (prim == no_prim) {
                block.clear(lane);
                continue;
            }
            const Triangle triangle = triangles_[prim];
            block.set(lane, triangle, prim);
            box = unite(box, bounds(triangle));
        }
        return box;
    }

    const Bvh& tree_;
    const TriangleView& triangles_;
    const Planner& plans_;
    WideBvh out_;
    std::vector<Listed> listed_;
    std::vector<PrimId> prims_;
};

} // namespace

WideBvh collapse_weighed(
    const Bvh& tree,
    const TriangleView& triangles,
    const NodeWeights& weights,
    const CollapseParams& params,
    const Executor& executor
) {
    check(params);
    const Planner plans(tree, weights, params, executor);
    return Writer(tree, triangles, plans).write(executor);
}

} // namespace detail

} // namespace raywise
