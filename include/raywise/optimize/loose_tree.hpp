// A tree whose subtrees can be moved, and moved back.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/optimize/node_masses.hpp>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise {

/// The nodes of a tree by their place; siblings stand side by side. Keeps the parent, the mass and
/// the height (0 of a leaf) of every node, and the summed mass of the inner ones.
template <HitMeasure M>
class LooseTree {
public:
    using Index = std::uint32_t;
    static constexpr Index root = 0;

    /// `tree` must be valid and not empty; `measure` must outlive this. Inner boxes become the
    /// union of their children's.
    LooseTree(const Bvh& tree, const M& measure, const Executor& executor = serial_executor())
        : measure_(measure), entries_(tree.nodes.size()) {
        // Input boxes may be wider than their children's: those weigh anew.
        const std::vector<float> masses = node_masses(tree, measure, executor);
        for (std::size_t i = tree.nodes.size(); i-- > 0;) {
            Entry& entry = entries_[i];
            entry.node = tree.nodes[i];
            entry.mass = masses[i];
            if (entry.node.is_leaf()) continue;
            const auto left = static_cast<Index>(entry.node.left());
            entries_[left].parent = static_cast<Index>(i);
            entries_[left + 1].parent = static_cast<Index>(i);
            fit(static_cast<Index>(i));
            inner_mass_ += static_cast<double>(entry.mass);
        }
    }

    [[nodiscard]] std::size_t size() const { return entries_.size(); }

    [[nodiscard]] const Node& node(Index i) const { return entries_[i].node; }

    [[nodiscard]] const Aabb& box(Index i) const { return entries_[i].node.box(); }

    [[nodiscard]] float mass(Index i) const { return entries_[i].mass; }

    [[nodiscard]] Index parent(Index i) const { return entries_[i].parent; }

    [[nodiscard]] static Index sibling(Index i) { return (i & 1U) != 0 ? i + 1 : i - 1; }

    [[nodiscard]] Index left(Index i) const { return static_cast<Index>(node(i).left()); }

    [[nodiscard]] double inner_mass() const { return inner_mass_; }

    [[nodiscard]] float mass_of(const Aabb& box) const { return static_cast<float>(measure_(box)); }

    /// Takes `moved` out and puts it back as a sibling of what is at `target`, if that lowers the
    /// inner mass and keeps the depth in bounds; answers whether it did. Both places may hold other
    /// nodes afterwards: what stood beside `moved` moves up, what was at `target` moves down.
    bool move(Index moved, Index target);

private:
    struct Entry {
        Node node;
        Index parent = root;
        float mass = 0;
        std::uint32_t height = 0;
    };

    struct Change {
        Index at = 0;
        Entry before;
    };

    /// Box, mass and height of an inner node from its children's.
    void fit(Index i) {
        Entry& entry = entries_[i];
        const Entry& left = entries_[to_index(entry.node.left())];
        const Entry& right = entries_[to_index(entry.node.right())];
        const Aabb box = unite(left.node.box(), right.node.box());
        // A measure may be dear.
        if (!(box == entry.node.box())) {
            entry.node.set_box(box);
            entry.mass = mass_of(box);
        }
        entry.height = 1 + std::max(left.height, right.height);
    }

    /// Fits `i` and its ancestors, as far up as anything changes.
    void fit_upward(Index i) {
        for (;;) {
            const Entry before = entries_[i];
            save(i);
            fit(i);
            const Entry& after = entries_[i];
            inner_mass_ += static_cast<double>(after.mass) - static_cast<double>(before.mass);
            const bool is_same =
                before.node.box() == after.node.box() && before.height == after.height;
            if (is_same || i == root) return;
            i = entries_[i].parent;
        }
    }

    /// Puts what was at another place to `i`.
    void put(Index i, const Entry& entry) {
        save(i);
        const Index parent = entries_[i].parent;
        entries_[i] = entry;
        entries_[i].parent = parent;
        if (entry.node.is_leaf()) return;
        const auto left = static_cast<Index>(entry.node.left());
        save(left);
        save(left + 1);
        entries_[left].parent = i;
        entries_[left + 1].parent = i;
    }

    void save(Index i) { changes_.push_back({i, entries_[i]}); }

    void undo() {
        while (!changes_.empty()) {
            entries_[changes_.back().at] = changes_.back().before;
            changes_.pop_back();
        }
    }

    [[nodiscard]] bool may_move(Index moved, Index target) const;

    const M& measure_;
    std::vector<Entry> entries_;
    std::vector<Change> changes_; ///< of the move under way
    double inner_mass_ = 0;
};

template <HitMeasure M>
bool LooseTree<M>::may_move(Index moved, Index target) const {
    if (moved == root || parent(moved) == root) return false;
    if (target == moved || target == parent(moved) || target == sibling(moved)) return false;
    std::size_t depth = 0;
    for (Index i = target; i != root; i = parent(i), ++depth)
        if (i == moved) return false;
    // What is at the target and what is moved both stand one level below it afterwards.
    const std::size_t height = std::max(entries_[target].height, entries_[moved].height);
    return depth + 1 + height <= static_cast<std::size_t>(Bvh::max_depth);
}

template <HitMeasure M>
bool LooseTree<M>::move(Index moved, Index target) {
    if (!may_move(moved, target)) return false;
    changes_.clear();
    const double mass_before = inner_mass_;
    const Entry taken = entries_[moved];

    // The sibling takes its parent's place; the pair becomes free.
    const Index hole = parent(moved);
    const Index pair = std::min(moved, sibling(moved));
    inner_mass_ -= static_cast<double>(mass(hole));
    put(hole, entries_[sibling(moved)]);
    fit_upward(parent(hole));

    // The pair goes where the target was, and the target into the pair.
    save(pair);
    save(pair + 1);
    const Entry at_target = entries_[target];
    entries_[pair].parent = target;
    entries_[pair + 1].parent = target;
    put(pair, at_target);
    put(pair + 1, taken);
    save(target);
    entries_[target].node = Node::inner(Aabb{}, static_cast<NodeId>(pair));
    entries_[target].mass = 0;
    fit_upward(target);
    if (inner_mass_ < mass_before) return true;
    undo();
    inner_mass_ = mass_before;
    return false;
}

} // namespace raywise
