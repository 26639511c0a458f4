// A tree together with its triangles, as queries go through it: binary, to be looked at node by
// node, or wide, to be fast.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/toplevel/served.hpp>
#include <raywise/trace/all_hits.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/closest_hit.hpp>
#include <raywise/trace/triangles.hpp>
#include <raywise/trace/wide.hpp>

#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

namespace raywise {

/// A binary tree and its triangles in the order of its slots.
struct BinaryTree {
    Bvh tree;
    PackedTriangles triangles;
};

/// Answers queries over the triangles of one tree; both kinds give the same (t, id), but for wide
/// trees in TraceMode::fast. A default one holds nothing: every ray misses.
class TracedTree {
public:
    TracedTree() = default;

    /// Every id in `tree.prims` must be below `triangles.size()`.
    TracedTree(Bvh tree, const TriangleView& triangles) : tree_(BinaryTree{std::move(tree), {}}) {
        auto& binary = std::get<BinaryTree>(tree_);
        binary.triangles = PackedTriangles(binary.tree, triangles);
    }

    explicit TracedTree(WideBvh tree) : tree_(std::move(tree)) {}

    /// The binary tree, or null when this is a wide one.
    [[nodiscard]] const BinaryTree* binary() const { return std::get_if<BinaryTree>(&tree_); }

    /// The wide tree, or null when this is a binary one.
    [[nodiscard]] const WideBvh* wide() const { return std::get_if<WideBvh>(&tree_); }

    [[nodiscard]] bool is_empty() const {
        return wide() != nullptr ? wide()->is_empty() : binary()->tree.is_empty();
    }

    /// Bytes of the nodes, and of the triangles.
    [[nodiscard]] std::size_t size_in_bytes() const;

    template <QueryObserver Observer>
    [[nodiscard]] std::optional<Hit>
    closest_hit(const Ray& ray, Observer& seen, TraceMode mode = TraceMode::watertight) const {
        if (const WideBvh* tree = wide()) {
            if constexpr (std::is_same_v<Observer, SilentQuery>) {
                return raywise::closest_hit(*tree, ray, mode);
            } else {
                Counts counts;
                const auto hit = raywise::closest_hit(*tree, ray, counts, mode);
                seen.steps(counts);
                return hit;
            }
        }
        return raywise::closest_hit(binary()->tree, binary()->triangles, ray, seen);
    }

    template <QueryObserver Observer>
    [[nodiscard]] bool
    any_hit(const Ray& ray, Observer& seen, TraceMode mode = TraceMode::watertight) const {
        if (const WideBvh* tree = wide()) {
            if constexpr (std::is_same_v<Observer, SilentQuery>) {
                return raywise::any_hit(*tree, ray, mode);
            } else {
                Counts counts;
                const bool hit = raywise::any_hit(*tree, ray, counts, mode);
                seen.steps(counts);
                return hit;
            }
        }
        return raywise::any_hit(binary()->tree, binary()->triangles, ray, seen);
    }

    /// Calls `visit(const Hit&)` for every hit, in no particular order; once per triangle, unless
    /// the tree holds some in several slots.
    template <class Visitor>
    void all_hits(const Ray& ray, Visitor&& visit, TraceMode mode = TraceMode::watertight) const {
        if (const WideBvh* tree = wide())
            raywise::all_hits(*tree, ray, visit, mode);
        else
            raywise::all_hits(binary()->tree, binary()->triangles, ray, visit);
    }

private:
    std::variant<BinaryTree, WideBvh> tree_;
};

} // namespace raywise
