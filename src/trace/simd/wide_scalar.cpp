#include "trace/simd/wide_kernels.hpp"
#include "trace/simd/wide_scalar.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_box.hpp>
#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/trace/observer.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace raywise::simd {
namespace {

/// Calls `visit(hit, limit)` for hits at t <= limit, which it may lower; returns whether to go on.
template <class Visit>
void traverse(const WideBvh& tree, const Ray& ray, Counts& counts, Visit&& visit) {
    if (!is_valid(ray)) return;
    // Only world boxes can be met by a ray of any size; in another frame every box is opened.
    const bool is_world = tree.frame.is_world();
    const WideSlab slab(ray);
    float limit = ray.t_max;
    std::array<WideRef, WideBvh::max_depth*(WideNode::width - 1) + 1> stack;
    std::size_t height = 0;
    stack[height++] = WideRef::node(0);

    const auto open_leaf = [&](const TriangleBlock* block) {
        counts.leaf(NodeId{});
        for (;; ++block) {
            for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane) {
                const PrimId prim = block->prims[lane];
                counts.prim(prim);
                if (prim == no_prim || prim == ray.excluded) continue;
                const auto hit = ExactKernel::decide(ray, block->triangle(lane), prim, limit);
                if (hit && !visit(*hit, limit)) return false;
            }
            if (block->is_last != 0) return true;
        }
    };

    while (height > 0) {
        const WideRef current = stack[--height];
        if (current.is_leaf()) {
            if (!open_leaf(&tree.blocks[current.index()])) return;
            continue;
        }
        counts.inner(NodeId{});
        counts.box_tests(WideNode::width);
        const WideNode& node = tree.nodes[current.index()];
        for (std::size_t slot = 0; slot < WideNode::width && node.is_used(slot); ++slot)
            if (!is_world || slab(node.box(slot), static_cast<double>(limit)).hit)
                stack[height++] = node.children[slot];
    }
}

std::optional<Hit> closest(const WideBvh& tree, const Ray& ray) {
    Counts counts;
    return closest_scalar(tree, ray, counts);
}

bool any(const WideBvh& tree, const Ray& ray) {
    Counts counts;
    return any_scalar(tree, ray, counts);
}

void closest_batch(const WideBvh& tree, const Ray* rays, Hit* hits, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        hits[i] = closest(tree, rays[i]).value_or(Hit{});
}

void any_batch(const WideBvh& tree, const Ray* rays, bool* occluded, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        occluded[i] = any(tree, rays[i]);
}

} // namespace

std::optional<Hit> closest_scalar(const WideBvh& tree, const Ray& ray, Counts& counts) {
    std::optional<Hit> best;
    traverse(tree, ray, counts, [&](const Hit& hit, float& limit) {
        if (!best || is_closer(hit, *best)) {
            best = hit;
            limit = hit.t;
        }
        return true;
    });
    return best;
}

bool any_scalar(const WideBvh& tree, const Ray& ray, Counts& counts) {
    bool is_hit = false;
    traverse(tree, ray, counts, [&](const Hit&, float&) {
        is_hit = true;
        return false;
    });
    return is_hit;
}

void all_scalar(const WideBvh& tree, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    Counts counts;
    traverse(tree, ray, counts, [&](const Hit& hit, float&) {
        visit(hit);
        return true;
    });
}

const WideKernelTable& scalar_kernels() {
    static constexpr WideKernels kernels{
        &closest, &any, &all_scalar, &closest_scalar, &any_scalar, &closest_batch, &any_batch
    };
    static constexpr WideKernelTable table{kernels, kernels};
    return table;
}

} // namespace raywise::simd
