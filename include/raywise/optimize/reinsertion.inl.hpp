// The body of reinsert.
#pragma once

#include <raywise/optimize/depth_first.hpp>
#include <raywise/optimize/loose_tree.hpp>
#include <raywise/optimize/reinsertion.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace raywise {

/// Where a node had better be, and by how much.
struct Reinsertion {
    std::uint32_t moved = 0;
    std::uint32_t target = 0;
    double gain = 0; ///< of inner mass; 0: it is best where it is
};

/// Finds the best place for one node. Every place whose gain could still be the greatest is looked
/// at: from the parent up, and down from each sibling passed, as long as the mass that a place
/// costs at least leaves something to gain. [Meister18]
template <HitMeasure M>
[[nodiscard]] Reinsertion find_place(const LooseTree<M>& tree, std::uint32_t moved) {
    using Index = std::uint32_t;
    struct Pending {
        Index node;
        double saved;
    };

    Reinsertion best{moved, moved, 0};
    const Aabb& box = tree.box(moved);
    const auto least = static_cast<double>(tree.mass(moved));
    std::array<Pending, Bvh::max_depth + 2> pending; // NOLINT(*-member-init): written before read

    const auto consider = [&](Index target, double gain) {
        if (gain > best.gain) best = {moved, target, gain};
    };
    const auto search_below = [&](Index top, double saved_above) {
        std::size_t count = 0;
        pending[count++] = {top, saved_above};
        while (count > 0) {
            const Pending at = pending[--count];
            if (at.saved - least <= best.gain) continue;
            const auto merged = static_cast<double>(tree.mass_of(unite(tree.box(at.node), box)));
            consider(at.node, at.saved - merged);
            if (tree.node(at.node).is_leaf()) continue;
            const double saved = at.saved - merged + static_cast<double>(tree.mass(at.node));
            if (saved - least <= best.gain) continue;
            const Index left = tree.left(at.node);
            pending[count++] = {left, saved};
            pending[count++] = {left + 1, saved};
        }
    };

    // `saved`: what the ancestors passed so far lose in mass when the node leaves them.
    const Index parent = tree.parent(moved);
    auto saved = static_cast<double>(tree.mass(parent));
    Aabb rest = tree.box(LooseTree<M>::sibling(moved));
    search_below(LooseTree<M>::sibling(moved), saved);
    for (Index pivot = parent; pivot != LooseTree<M>::root;) {
        const Index sibling = LooseTree<M>::sibling(pivot);
        search_below(sibling, saved);
        pivot = tree.parent(pivot);
        rest = unite(rest, tree.box(sibling));
        const auto mass = static_cast<double>(tree.mass(pivot));
        // A measure may be dear, and far up nothing shrinks any more.
        if (!(rest == tree.box(pivot))) saved += mass - static_cast<double>(tree.mass_of(rest));
        consider(pivot, saved - mass);
    }
    return best;
}

/// The nodes of most mass, but for the root, its children and those that are settled; ties by
/// place.
template <HitMeasure M>
[[nodiscard]] std::vector<std::uint32_t> heaviest_nodes(
    const LooseTree<M>& tree,
    std::size_t count,
    const std::vector<std::uint8_t>& is_settled
) {
    std::vector<std::uint32_t> nodes;
    nodes.reserve(tree.size());
    for (std::uint32_t i = 1; i < tree.size(); ++i)
        if (is_settled[i] == 0 && tree.parent(i) != LooseTree<M>::root) nodes.push_back(i);
    if (count >= nodes.size()) return nodes;
    const auto is_heavier = [&](std::uint32_t a, std::uint32_t b) {
        return tree.mass(a) > tree.mass(b) || (tree.mass(a) == tree.mass(b) && a < b);
    };
    const auto end = nodes.begin() + static_cast<std::ptrdiff_t>(count);
    std::nth_element(nodes.begin(), end, nodes.end(), is_heavier);
    nodes.erase(end, nodes.end());
    std::sort(nodes.begin(), nodes.end());
    return nodes;
}

/// One round: places are looked for in parallel in the tree as it is, then moves are made one by
/// one, the most gainful first. A node that is best where it is is settled: later rounds look at
/// lighter ones instead.
template <HitMeasure M>
void reinsert_once(
    LooseTree<M>& tree,
    std::size_t count,
    std::vector<std::uint8_t>& is_settled,
    const Executor& executor
) {
    constexpr std::size_t chunk = 128;
    const std::vector<std::uint32_t> nodes = heaviest_nodes(tree, count, is_settled);
    std::vector<Reinsertion> found(nodes.size());
    executor.for_each_chunk(nodes.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            found[i] = find_place(tree, nodes[i]);
    });
    for (const Reinsertion& r : found)
        if (!(r.gain > 0)) is_settled[r.moved] = 1;
    const auto is_useless = [](const Reinsertion& r) { return !(r.gain > 0); };
    found.erase(std::remove_if(found.begin(), found.end(), is_useless), found.end());
    std::sort(found.begin(), found.end(), [](const Reinsertion& a, const Reinsertion& b) {
        return a.gain > b.gain || (a.gain == b.gain && a.moved < b.moved);
    });
    for (const Reinsertion& r : found)
        tree.move(r.moved, r.target);
}

template <HitMeasure M>
Bvh reinsert(
    const Bvh& tree,
    const M& measure,
    const ReinsertionParams& params,
    const Executor& executor
) {
    check(params);
    if (tree.nodes.size() < 5) return tree;
    const auto optimize = [&](const M& local) {
        LooseTree<M> loose(tree, local, executor);
        std::vector<std::uint8_t> is_settled(loose.size(), 0);
        const double share = params.batch * static_cast<double>(loose.size());
        for (int round = 0; round < params.max_rounds; ++round) {
            const double before = loose.inner_mass();
            reinsert_once(loose, static_cast<std::size_t>(share) + 1, is_settled, executor);
            if (!(before - loose.inner_mass() > params.least_gain * before)) break;
        }
        Bvh result;
        result.prims = tree.prims;
        result.nodes.reserve(loose.size());
        for (std::uint32_t i = 0; i < loose.size(); ++i)
            result.nodes.push_back(loose.node(i));
        return depth_first(result);
    };
    if constexpr (NarrowableMeasure<M>)
        return optimize(measure.narrowed(tree.root().box()));
    else
        return optimize(measure);
}

} // namespace raywise
