// A tree for tests of what uses trees: halves along the longest side, nothing clever.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise::test_support {

struct MedianSplit {
    const TriangleView& triangles;
    std::size_t leaf_size;
    Bvh tree{};

    void fill(std::size_t at, std::size_t first, std::size_t last) {
        Aabb box;
        for (std::size_t i = first; i < last; ++i)
            box = unite(box, bounds(triangles[tree.prims[i]]));
        if (last - first <= leaf_size) {
            tree.nodes[at] = Node::leaf(
                box, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first)
            );
            return;
        }
        const int axis = dominant_axis(box.size());
        const auto by_center = [&](PrimId a, PrimId b) {
            return bounds(triangles[a]).center()[axis] < bounds(triangles[b]).center()[axis];
        };
        const std::size_t middle = (first + last) / 2;
        const auto slot = [&](std::size_t i) {
            return tree.prims.begin() + static_cast<std::ptrdiff_t>(i);
        };
        std::nth_element(slot(first), slot(middle), slot(last), by_center);
        const std::size_t left = tree.nodes.size();
        tree.nodes.resize(left + 2);
        tree.nodes[at] = Node::inner(box, to_node(left));
        fill(left, first, middle);
        fill(left + 1, middle, last);
    }
};

/// `leaf_size` >= 1. The triangles must be finite.
inline Bvh median_split(const TriangleView& triangles, std::size_t leaf_size = 2) {
    MedianSplit split{triangles, leaf_size};
    if (triangles.size() == 0) return {};
    for (std::size_t i = 0; i < triangles.size(); ++i)
        split.tree.prims.push_back(to_prim(i));
    split.tree.nodes.resize(1);
    split.fill(0, 0, triangles.size());
    return split.tree;
}

} // namespace raywise::test_support
