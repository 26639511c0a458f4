// The way down from the root that the three-axis builders share: divide a node, go on in both
// children, in parallel while there is enough to do.
#pragma once

#include <raywise/build/node_metric.hpp>
#include <raywise/build/tree_assembly.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace raywise {

/// Puts nodes into their room. A task has the node's `range` of primitives, its `slot` and its
/// `box`. `divide(task, measure, executor)` answers with an optional pair `left`, `right` of tasks,
/// whose slots are set here, or with nothing when it has put a leaf.
template <class Divide>
class Descent {
public:
    Descent(NodeRoom& nodes, const Executor& executor, Divide divide)
        : nodes_(nodes), executor_(executor), divide_(std::move(divide)) {}

    /// Puts the descendants of the task's node, and the node; returns the blocks in their order.
    template <class Task, HitMeasure M>
    [[nodiscard]] NodeBlocks operator()(const Task& task, const M& measure) const {
        if (executor_.threads() == 1 || task.range.count() < parallel_grain) {
            const std::size_t begin = NodeRoom::first_slot(task.range.first);
            const std::size_t end = serially(task, measure, begin);
            return end > begin ? NodeBlocks{{begin, end}} : NodeBlocks{};
        }
        auto children = divide_(task, measure, executor_);
        if (!children) return {};

        auto& [left, right] = *children;
        const std::size_t pair = NodeRoom::pair_slot(right.range.first);
        put_inner(task, left, right, pair);
        NodeBlocks left_blocks;
        NodeBlocks right_blocks;
        executor_.invoke(
            [&, &near = left] { left_blocks = (*this)(near, narrowed_to(measure, near.box)); },
            [&, &far = right] { right_blocks = (*this)(far, narrowed_to(measure, far.box)); }
        );
        NodeBlocks all{{pair, pair + 2}};
        all.insert(all.end(), left_blocks.begin(), left_blocks.end());
        all.insert(all.end(), right_blocks.begin(), right_blocks.end());
        return all;
    }

private:
    /// Subtrees of fewer primitives stay on one thread.
    static constexpr std::size_t parallel_grain = 2048;

    /// Puts the descendants at `next` and after; returns the slot behind the last.
    template <class Task, HitMeasure M>
    [[nodiscard]] std::size_t serially(const Task& task, const M& measure, std::size_t next) const {
        auto children = divide_(task, measure, serial_executor());
        if (!children) return next;
        auto& [left, right] = *children;
        put_inner(task, left, right, next);
        next = serially(left, narrowed_to(measure, left.box), next + 2);
        return serially(right, narrowed_to(measure, right.box), next);
    }

    template <class Task>
    void put_inner(const Task& task, Task& left, Task& right, std::size_t pair) const {
        left.slot = pair;
        right.slot = pair + 1;
        nodes_.put(task.slot, Node::inner(task.box, to_node(pair)));
    }

    NodeRoom& nodes_;
    const Executor& executor_;
    Divide divide_;
};

/// Puts the task's node as a leaf, and its primitives into its slots of `ids`.
template <class Task>
void put_leaf(NodeRoom& nodes, std::vector<PrimId>& ids, const Task& task) {
    for (std::size_t i = task.range.first; i < task.range.last; ++i)
        ids[i] = task.range.from[i].id();
    nodes.put(
        task.slot,
        Node::leaf(
            task.box,
            static_cast<std::uint32_t>(task.range.first),
            static_cast<std::uint32_t>(task.range.count())
        )
    );
}

/// Whether testing `count` primitives costs no more than a split of SplitCost::sum `sum` at a node
/// of that mass.
[[nodiscard]] inline bool
is_leaf_cheaper(const CostConstants& cost, std::size_t count, double sum, float mass) {
    const double split = 2 * cost.node + cost.prim * (sum / static_cast<double>(mass));
    return !(split < cost.prim * static_cast<double>(count));
}

} // namespace raywise
