#include "trace/simd/wide_scalar.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_box.hpp>
#include <raywise/geometry/ray_triangle.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace raywise::simd {
namespace {

/// Calls `visit(hit, limit)` for hits at t <= limit, which it may lower; returns whether to go on.
template <class Visit>
void traverse(const WideBvh& tree, const Ray& ray, Visit&& visit) {
    // Only world boxes can be met by a ray of any size; in another frame every box is opened.
    const bool is_world = tree.frame.is_world();
    const WideSlab slab(ray);
    float limit = ray.t_max;
    std::array<WideRef, WideBvh::max_depth*(WideNode::width - 1) + 1> stack;
    std::size_t height = 0;
    stack[height++] = WideRef::node(0);

    const auto open_leaf = [&](const TriangleBlock* block) {
        for (;; ++block) {
            for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane) {
                const PrimId prim = block->prims[lane];
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
        const WideNode& node = tree.nodes[current.index()];
        for (std::size_t slot = 0; slot < WideNode::width && node.is_used(slot); ++slot)
            if (!is_world || slab(node.box(slot), static_cast<double>(limit)).hit)
                stack[height++] = node.children[slot];
    }
}

} // namespace

std::optional<Hit> closest_scalar(const WideBvh& tree, const Ray& ray) {
    std::optional<Hit> best;
    traverse(tree, ray, [&](const Hit& hit, float& limit) {
        if (!best || is_closer(hit, *best)) {
            best = hit;
            limit = hit.t;
        }
        return true;
    });
    return best;
}

bool any_scalar(const WideBvh& tree, const Ray& ray) {
    bool is_hit = false;
    traverse(tree, ray, [&](const Hit&, float&) {
        is_hit = true;
        return false;
    });
    return is_hit;
}

void all_scalar(const WideBvh& tree, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    traverse(tree, ray, [&](const Hit& hit, float&) {
        visit(hit);
        return true;
    });
}

} // namespace raywise::simd
