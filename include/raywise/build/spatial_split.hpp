// The cheapest plane that may cut triangles, and where each reference goes when it is carried out.
#pragma once

#include <raywise/build/cut_triangle.hpp>
#include <raywise/build/node_metric.hpp>
#include <raywise/build/prim_box.hpp>
#include <raywise/build/spatial_bins.hpp>
#include <raywise/build/split.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/large_buffer.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace raywise {

/// A plane between two parts of a node's box.
struct SpatialSplit {
    SplitCost cost;
    std::size_t left_count = 0; ///< 0: none was found
    std::size_t right_count = 0;
    int axis = 0;
    float plane = 0;
    QuadBox left; ///< of the pieces, about
    QuadBox right;
};

/// Sweeps the planes of one axis.
template <class Measure>
void sweep_spatial(
    const SpatialBins& bins,
    const SpatialGrid& grid,
    std::size_t count,
    int axis,
    const Measure& measure,
    SpatialSplit& best
) {
    const int parts = grid.part_count();
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written before it is read.
    std::array<float, SpatialGrid::most> right_mass;
    QuadBox box;
    for (int part = parts - 1; part > 0; --part) {
        box.unite(bins.box(part, axis));
        right_mass[static_cast<std::size_t>(part)] =
            to_aabb(box).is_empty() ? 0 : mass_of(measure, box);
    }
    box = {};
    std::size_t left_count = 0;
    std::size_t right_count = count;
    for (int part = 1; part < parts; ++part) {
        box.unite(bins.box(part - 1, axis));
        left_count += bins.entries(part - 1, axis);
        right_count -= bins.exits(part - 1, axis);
        if (left_count == 0 || right_count == 0) continue;
        const float right = right_mass[static_cast<std::size_t>(part)];
        const double right_sum = static_cast<double>(right) * static_cast<double>(right_count);
        if (right_sum > best.cost.sum) continue;
        const float left = to_aabb(box).is_empty() ? 0 : mass_of(measure, box);
        const SplitCost cost{
            static_cast<double>(left) * static_cast<double>(left_count) + right_sum,
            std::max(left_count, right_count),
            left,
            right
        };
        if (!cost.is_better_than(best.cost)) continue;
        best.cost = cost;
        best.left_count = left_count;
        best.right_count = right_count;
        best.axis = axis;
        best.plane = grid.plane(axis, part);
        best.left = box;
    }
}

/// Where a reference goes.
enum class Way : std::uint8_t { left, right, both };

/// How many references go where, and what they bound.
struct SpatialHalves {
    std::size_t left_count = 0;
    std::size_t right_count = 0;
    CentroidBounds centroids;
    QuadBox left;
    QuadBox right;

    void unite(const SpatialHalves& other) {
        left_count += other.left_count;
        right_count += other.right_count;
        centroids.unite(other.centroids);
        left.unite(other.left);
        right.unite(other.right);
    }
};

/// Decides for every reference of a chunk: sides by the plane; one that both sides see stays whole
/// where that is not dearer [Stich09], weighed against the boxes of the split itself, so that the
/// order of references does not matter.
template <class Measure>
SpatialHalves choose_ways(
    const PrimBox* items,
    std::size_t count,
    const TriangleView& triangles,
    const SpatialSplit& split,
    const Measure& measure,
    Way* ways
) {
    SpatialHalves halves;
    const int axis = split.axis;
    const auto left_count = static_cast<double>(split.left_count);
    const auto right_count = static_cast<double>(split.right_count);
    const auto left_mass = static_cast<double>(split.cost.left_mass);
    const auto right_mass = static_cast<double>(split.cost.right_mass);
    const auto widened = [&](QuadBox box, const PrimBox& item) {
        box.unite(item.lo, item.hi);
        return static_cast<double>(mass_of(measure, box));
    };
    const auto way_of = [&](const PrimBox& item) {
        if (item.hi[axis] <= split.plane) return Way::left;
        if (item.lo[axis] >= split.plane) return Way::right;
        const CutReference cut =
            cut_reference(item, corners_of(triangles, item.id()), axis, split.plane);
        if (CutReference::is_empty(cut.left)) return Way::right;
        if (CutReference::is_empty(cut.right)) return Way::left;
        const double whole_left =
            widened(split.left, item) * left_count + right_mass * (right_count - 1);
        const double whole_right =
            left_mass * (left_count - 1) + widened(split.right, item) * right_count;
        if (split.cost.sum < std::min(whole_left, whole_right)) return Way::both;
        return whole_left <= whole_right ? Way::left : Way::right;
    };
    for (std::size_t i = 0; i < count; ++i) {
        ways[i] = way_of(items[i]);
        halves.left_count += ways[i] != Way::right ? std::size_t{1} : std::size_t{0};
        halves.right_count += ways[i] != Way::left ? std::size_t{1} : std::size_t{0};
    }
    return halves;
}

/// Moves the references of a chunk to `left` and `right` on, cutting those that go both ways.
inline SpatialHalves scatter_ways(
    const PrimBox* items,
    std::size_t count,
    const TriangleView& triangles,
    const SpatialSplit& split,
    const Way* ways,
    PrimBox* left,
    PrimBox* right
) {
    SpatialHalves halves;
    const auto put_left = [&](const PrimBox& item) {
        *left++ = item;
        halves.left.unite(item.lo, item.hi);
        halves.centroids.left.unite(item.centroid());
    };
    const auto put_right = [&](const PrimBox& item) {
        *right++ = item;
        halves.right.unite(item.lo, item.hi);
        halves.centroids.right.unite(item.centroid());
    };
    for (std::size_t i = 0; i < count; ++i) {
        if (ways[i] == Way::left) {
            put_left(items[i]);
        } else if (ways[i] == Way::right) {
            put_right(items[i]);
        } else {
            const CutReference cut = cut_reference(
                items[i], corners_of(triangles, items[i].id()), split.axis, split.plane
            );
            put_left(cut.left);
            put_right(cut.right);
        }
    }
    return halves;
}

} // namespace raywise
