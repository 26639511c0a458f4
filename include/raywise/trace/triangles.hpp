// Where a traversal reads its triangles: the caller's mesh, or a copy in leaf order.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <concepts>
#include <cstddef>
#include <vector>

namespace raywise {

/// Answers the triangle in a slot of a tree; `tree.prims[slot]` is its id.
template <class T>
concept TriangleSource = requires(const T& triangles, const Bvh& tree, std::size_t slot) {
    { triangles.triangle(tree, slot) } -> std::convertible_to<Triangle>;
};

/// Reads the caller's mesh through the tree's ids; copies nothing.
class IndexedTriangles {
public:
    explicit IndexedTriangles(const TriangleView& view) : view_(view) {}

    [[nodiscard]] Triangle triangle(const Bvh& tree, std::size_t slot) const {
        return view_[tree.prims[slot]];
    }

private:
    TriangleView view_;
};

/// A copy in the order of the slots of one tree: 36 bytes per slot, one stream of memory per leaf.
class PackedTriangles {
public:
    PackedTriangles() = default;

    /// Every id in `tree.prims` must be below `view.size()`.
    PackedTriangles(const Bvh& tree, const TriangleView& view) {
        triangles_.reserve(tree.prims.size());
        for (const PrimId id : tree.prims)
            triangles_.push_back(view[id]);
    }

    [[nodiscard]] const Triangle& triangle(const Bvh&, std::size_t slot) const {
        return triangles_[slot];
    }

    [[nodiscard]] std::size_t size_in_bytes() const { return triangles_.size() * sizeof(Triangle); }

private:
    std::vector<Triangle> triangles_;
};

static_assert(TriangleSource<IndexedTriangles> && TriangleSource<PackedTriangles>);

} // namespace raywise
