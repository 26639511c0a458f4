// Who watches a traversal: nobody, or a counter.
#pragma once

#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/ids.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>

namespace raywise {

/// Told of every step of a traversal: box tests made, inner nodes and leaves opened, triangles
/// tested.
template <class O>
concept TraceObserver = requires(O& seen, std::size_t count, NodeId node, PrimId prim) {
    seen.box_tests(count);
    seen.inner(node);
    seen.leaf(node);
    seen.prim(prim);
};

/// Watches nothing, costs nothing.
struct Silent {
    static constexpr void box_tests(std::size_t) {}
    static constexpr void inner(NodeId) {}
    static constexpr void leaf(NodeId) {}
    static constexpr void prim(PrimId) {}
};

/// Counts the steps of any number of traversals.
struct Counts {
    std::uint64_t boxes = 0;  ///< box tests, the root's included
    std::uint64_t inners = 0; ///< inner nodes opened: hit, and not pruned
    std::uint64_t leaves = 0; ///< leaves opened
    std::uint64_t prims = 0;  ///< triangle tests

    constexpr void box_tests(std::size_t count) { boxes += count; }
    constexpr void inner(NodeId) { ++inners; }
    constexpr void leaf(NodeId) { ++leaves; }
    constexpr void prim(PrimId) { ++prims; }

    [[nodiscard]] constexpr std::uint64_t node_visits() const { return inners + leaves; }

    friend constexpr bool operator==(const Counts&, const Counts&) = default;

    constexpr Counts& operator+=(const Counts& other) {
        boxes += other.boxes;
        inners += other.inners;
        leaves += other.leaves;
        prims += other.prims;
        return *this;
    }
};

/// 2 C_node per inner node opened plus C_prim per triangle test; the root's own test is free.
[[nodiscard]] constexpr double cost_of(const Counts& counts, const CostConstants& costs = {}) {
    return 2 * costs.node * static_cast<double>(counts.inners) +
           costs.prim * static_cast<double>(counts.prims);
}

static_assert(TraceObserver<Silent> && TraceObserver<Counts>);

} // namespace raywise
