// Boxes that builders find hard, measures that see them strangely, and the cost of what comes out.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raywise::testing {

struct BoxSet {
    std::string name;
    std::vector<Aabb> boxes;
};

/// Boxes of up to `side` at random places of the unit cube.
inline std::vector<Aabb> soup(std::size_t count, float side, std::uint64_t seed = 1) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(seed, i);
        const Vec3 lo{rng.uniform(), rng.uniform(), rng.uniform()};
        const Vec3 size{rng.uniform(), rng.uniform(), rng.uniform()};
        boxes.push_back({lo, lo + size * side});
    }
    return boxes;
}

inline Aabb cube(Vec3 center, float half) {
    const Vec3 h{half, half, half};
    return {center - h, center + h};
}

/// `count` boxes made by `make(i)`, i as float.
template <class Make>
std::vector<Aabb> series(std::size_t count, const Make& make) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < count; ++i)
        boxes.push_back(make(static_cast<float>(i)));
    return boxes;
}

inline std::vector<BoxSet> pathological_sets() {
    const auto row = [](float i) { return cube({i, 0, 0}, 0.25F); };
    std::vector<Aabb> mixed = soup(300, 0.01F);
    for (const Aabb& box : series(300, [](float) { return cube({0.5F, 0.5F, 0.5F}, 0.1F); }))
        mixed.push_back(box);
    mixed.push_back({{-0x1p60F, -0x1p60F, -0x1p60F}, {0x1p60F, 0x1p60F, 0x1p60F}});
    return {
        {"one", {cube({1, 2, 3}, 1)}},
        {"two apart", {cube({0, 0, 0}, 1), cube({9, 9, 9}, 1)}},
        {"identical", series(1000, [](float) { return cube({1, 2, 3}, 1); })},
        {"identical points", series(1000, [](float) { return cube({1, 2, 3}, 0); })},
        {"row", series(777, row)},
        {"points on a line", series(777, [](float i) { return cube({i, i, i}, 0); })},
        {"points on an axis", series(777, [](float i) { return cube({0, i, 0}, 0); })},
        {"flat",
         series(
             500,
             [](float i) {
                 return Aabb{
                     {std::fmod(i, 20.F), i / 20, 0}, {std::fmod(i, 20.F) + 1, i / 20 + 1, 0}
                 };
             }
         )},
        {"concentric", series(500, [](float i) { return cube({0, 0, 0}, i + 1); })},
        {"nested at a corner", series(500, [](float i) { return Aabb{{0, 0, 0}, {i, i, i}}; })},
        {"growing series", series(120, [](float i) { return cube({std::exp2(i / 2), 0, 0}, 0.1F); })
        },
        {"shrinking series", series(290, [](float i) { return cube({std::exp2(-i / 2), 0, 0}, 0); })
        },
        {"shrinking cubes",
         series(
             290,
             [](float i) {
                 const float x = std::exp2(-i / 2);
                 return Aabb{{x / 2, x / 2, x / 2}, {x, x, x}};
             }
         )},
        {"tiny", series(300, [](float i) { return cube({i * 1e-42F, i * 2e-42F, 0}, 1e-43F); })},
        {"huge", series(300, [](float i) { return cube({(i - 150) * 0x1p52F, 0, 0}, 0x1p50F); })},
        {"negative zero",
         series(
             64,
             [](float i) {
                 const float zero = std::fmod(i, 2.F) == 0 ? 0.F : -0.F;
                 return Aabb{{zero, zero, zero}, {1, zero, std::fmod(i, 5.F)}};
             }
         )},
        {"one in front of many",
         series(
             500,
             [](float i) { return i == 0 ? cube({1e6F, 0, 0}, 1) : cube({1e-3F * i, 0, 0}, 1e-3F); }
         )},
        {"everything at once", mixed},
        {"soup", soup(3000, 0.05F)},
    };
}

/// Sees nothing.
struct BlindMeasure {
    float operator()(const Aabb&) const { return 0; }
};

/// Sees every box alike.
struct ConstantMeasure {
    float operator()(const Aabb& box) const { return box.is_empty() ? 0.F : 1.F; }
};

/// Of parallel rays along z through the square [-1, 0.5]^2: blind to most boxes.
struct WindowMeasure {
    float operator()(const Aabb& box) const {
        const Aabb seen = intersect(box, {{-1, -1, box.lo.z}, {0.5F, 0.5F, box.hi.z}});
        if (seen.is_empty()) return 0;
        return seen.size().x * seen.size().y;
    }
};

/// Share of given points that a box holds; can be narrowed to those inside a box.
struct PointMeasure {
    std::vector<Vec3> points;
    float each = 0;

    float operator()(const Aabb& box) const {
        float mass = 0;
        for (const Vec3 point : points)
            if (overlaps(box, {point, point})) mass += each;
        return mass;
    }

    [[nodiscard]] PointMeasure narrowed(const Aabb& box) const {
        PointMeasure result{{}, each};
        for (const Vec3 point : points)
            if (overlaps(box, {point, point})) result.points.push_back(point);
        return result;
    }
};

static_assert(NarrowableMeasure<PointMeasure>);

inline PointMeasure random_points(std::size_t count) {
    PointMeasure measure{{}, 1.F / static_cast<float>(count)};
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(99, i);
        measure.points.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
    }
    return measure;
}

inline std::vector<Vec3> centers(const std::vector<Aabb>& boxes) {
    std::vector<Vec3> result;
    for (const Aabb& box : boxes)
        result.push_back(box.center());
    return result;
}

/// Expected cost of a traversal by section 4.1, conditional on meeting the root.
template <HitMeasure M>
double tree_cost(const Bvh& tree, const M& measure, const CostConstants& cost = {}) {
    double sum = 0;
    for (const Node& node : tree.nodes) {
        const double steps =
            node.is_leaf() ? cost.prim * static_cast<double>(node.count()) : 2 * cost.node;
        sum += static_cast<double>(measure(node.box())) * steps;
    }
    return sum / static_cast<double>(measure(tree.root().box()));
}

inline bool same_bytes(const Bvh& a, const Bvh& b) {
    return std::as_bytes(std::span(a.nodes)).size() == std::as_bytes(std::span(b.nodes)).size() &&
           a.prims == b.prims &&
           std::equal(
               std::as_bytes(std::span(a.nodes)).begin(),
               std::as_bytes(std::span(a.nodes)).end(),
               std::as_bytes(std::span(b.nodes)).begin()
           );
}

} // namespace raywise::testing
