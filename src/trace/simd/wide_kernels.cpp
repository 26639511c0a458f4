// The kernels, compiled once for every instruction set.
#include "trace/simd/wide_kernels.hpp"
#include "trace/simd/wide_ray.hpp"
#include "trace/simd/wide_scalar.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_triangle.hpp>
#include <raywise/trace/observer.hpp>
#include <raywise/trace/wide.hpp>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/simd/wide_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Eight = hn::CappedTag<float, WideNode::width>;
using Four = hn::CappedTag<float, TriangleBlock::width>;

/// Bit i: lane i of the mask.
template <class D, class Mask>
HWY_INLINE std::uint32_t bits_of(D d, Mask mask) {
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(d, mask, bits.data());
    return bits[0];
}

HWY_INLINE const float* floats_at(const void* base, std::size_t bytes) {
    return reinterpret_cast<const float*>(static_cast<const std::byte*>(base) + bytes);
}

/// Where the ray enters the boxes of a node; bit i of the result: it meets box i at or before
/// `reach_limit`.
HWY_INLINE std::uint32_t enter_boxes(
    const WideRay& ray,
    const WideNode& node,
    float reach_limit,
    float* HWY_RESTRICT entries
) {
    const Eight d;
    std::uint32_t hits = 0;
    for (std::size_t first = 0; first < WideNode::width; first += hn::Lanes(d)) {
        const auto plane = [&](std::size_t offset)
                               HWY_ATTR { return hn::Load(d, floats_at(&node, offset) + first); };
        const auto near = [&](std::size_t axis) HWY_ATTR {
            const PlaneMap& map = ray.axes[axis];
            return hn::MulAdd(
                plane(map.near_offset), hn::Set(d, map.near_scale), hn::Set(d, map.near_shift)
            );
        };
        const auto far = [&](std::size_t axis) HWY_ATTR {
            const PlaneMap& map = ray.axes[axis];
            return hn::MulAdd(
                plane(map.far_offset), hn::Set(d, map.far_scale), hn::Set(d, map.far_shift)
            );
        };
        const auto entry =
            hn::Max(hn::Max(near(0), near(1)), hn::Max(near(2), hn::Set(d, ray.t_min)));
        const auto exit =
            hn::Min(hn::Min(far(0), far(1)), hn::Min(far(2), hn::Set(d, reach_limit)));
        hn::Store(entry, d, entries + first);
        hits |= bits_of(d, hn::Le(entry, exit)) << first;
    }
    return hits;
}

/// Lanes of a block that a query must look at.
struct Candidates {
    std::uint32_t possible;                          ///< may be hit at t in the interval
    std::uint32_t sure;                              ///< surely are
    std::array<float, TriangleBlock::width> t, u, v; ///< of the fast mode
};

template <TraceMode mode>
HWY_INLINE Candidates meet_block(const WideRay& ray, const TriangleBlock& block, float limit) {
    const Four d;
    Candidates out;
    out.possible = 0;
    out.sure = 0;
    for (std::size_t first = 0; first < TriangleBlock::width; first += hn::Lanes(d)) {
        constexpr std::size_t vertex_size = sizeof(block.vertices[0]);
        const auto depth_of = [&](std::size_t vertex) HWY_ATTR {
            return hn::Sub(
                hn::Load(d, floats_at(&block, vertex * vertex_size + ray.z) + first),
                hn::Set(d, ray.origin_z)
            );
        };
        const auto sheared =
            [&](std::size_t vertex, std::size_t axis, float origin, float shear, auto depth)
                HWY_ATTR {
                    return hn::NegMulAdd(
                        hn::Set(d, shear),
                        depth,
                        hn::Sub(
                            hn::Load(d, floats_at(&block, vertex * vertex_size + axis) + first),
                            hn::Set(d, origin)
                        )
                    );
                };
        const auto az = depth_of(0), bz = depth_of(1), cz = depth_of(2);
        const auto ax = sheared(0, ray.x, ray.origin_x, ray.shear_x, az);
        const auto ay = sheared(0, ray.y, ray.origin_y, ray.shear_y, az);
        const auto bx = sheared(1, ray.x, ray.origin_x, ray.shear_x, bz);
        const auto by = sheared(1, ray.y, ray.origin_y, ray.shear_y, bz);
        const auto cx = sheared(2, ray.x, ray.origin_x, ray.shear_x, cz);
        const auto cy = sheared(2, ray.y, ray.origin_y, ray.shear_y, cz);
        // Fast: rounded alike on both sides of an edge, so that noise does not make hits of points.
        const auto edge = [](auto px, auto qy, auto py, auto qx) HWY_ATTR {
            if constexpr (mode == TraceMode::fast)
                return hn::Sub(hn::Mul(px, qy), hn::Mul(py, qx));
            else
                return hn::MulSub(px, qy, hn::Mul(py, qx));
        };
        const auto u = edge(bx, cy, by, cx);
        const auto v = edge(cx, ay, cy, ax);
        const auto w = edge(ax, by, ay, bx);
        const auto least = hn::Min(hn::Min(u, v), w);
        const auto greatest = hn::Max(hn::Max(u, v), w);
        const auto prims = hn::Load(
            hn::RebindToUnsigned<Four>(),
            reinterpret_cast<const std::uint32_t*>(block.prims.data()) + first
        );
        const auto is_wanted = hn::RebindMask(
            d,
            hn::Ne(
                prims,
                hn::Set(hn::RebindToUnsigned<Four>(), static_cast<std::uint32_t>(ray.excluded))
            )
        );
        if constexpr (mode == TraceMode::fast) {
            const auto zero = hn::Zero(d);
            const auto inside =
                hn::And(is_wanted, hn::Or(hn::Ge(least, zero), hn::Le(greatest, zero)));
            if (hn::AllFalse(d, inside)) continue;
            const auto sum = hn::Add(hn::Add(u, v), w);
            const auto inverse = hn::Div(hn::Set(d, 1.0F), sum);
            const auto weight_b = hn::Mul(v, inverse), weight_c = hn::Mul(w, inverse);
            const auto depth =
                hn::MulAdd(weight_b, hn::Sub(bz, az), hn::MulAdd(weight_c, hn::Sub(cz, az), az));
            const auto t = hn::Mul(depth, hn::Set(d, ray.inverse_z));
            // The sum of a degenerate triangle is 0 and its t no number.
            const auto hit = hn::And(
                hn::And(inside, hn::Ne(sum, zero)),
                hn::And(hn::Ge(t, hn::Set(d, ray.t_min)), hn::Le(t, hn::Set(d, limit)))
            );
            hn::Store(t, d, out.t.data() + first);
            hn::Store(weight_b, d, out.u.data() + first);
            hn::Store(weight_c, d, out.v.data() + first);
            const std::uint32_t bits = bits_of(d, hit) << first;
            out.possible |= bits;
            out.sure |= bits;
        } else {
            const auto extent = hn::Load(d, block.doubled_extents.data() + first);
            const auto error = hn::MulAdd(
                extent, hn::Set(d, ray.edge_error_scale), hn::Set(d, ray.edge_error_shift)
            );
            const auto negative_error = hn::Neg(error);
            const auto near_inside =
                hn::And(is_wanted, hn::Or(hn::Ge(least, negative_error), hn::Le(greatest, error)));
            if (hn::AllFalse(d, near_inside)) continue;
            const auto sum = hn::Add(hn::Add(u, v), w);
            const auto inverse = hn::Div(hn::Set(d, 1.0F), sum);
            const auto depth = hn::MulAdd(
                hn::Mul(v, inverse),
                hn::Sub(bz, az),
                hn::MulAdd(hn::Mul(w, inverse), hn::Sub(cz, az), az)
            );
            const auto t = hn::Mul(depth, hn::Set(d, ray.inverse_z));
            const auto t_error = hn::MulAdd(
                hn::Mul(error, hn::Abs(inverse)),
                hn::MulAdd(extent, hn::Set(d, ray.t_error_scale), hn::Set(d, ray.t_error_slope)),
                hn::Set(d, ray.t_error_shift)
            );
            const auto low = hn::Sub(t, t_error), high = hn::Add(t, t_error);
            // What is no number is possible and not sure.
            const auto outside =
                hn::Or(hn::Gt(low, hn::Set(d, limit)), hn::Lt(high, hn::Set(d, ray.t_min)));
            out.possible |= bits_of(d, hn::AndNot(outside, near_inside)) << first;
            // Vertices may be farther from the ray than those of a triangle that it hits; within
            // twice that distance, twice the error and some more is enough.
            const auto is_close = hn::Le(hn::Max(hn::Abs(ax), hn::Abs(ay)), extent);
            const auto most_error = hn::Mul(hn::Set(d, 4.0F), error);
            const auto surely_inside = hn::And(
                hn::And(near_inside, is_close),
                hn::Or(hn::Gt(least, most_error), hn::Lt(greatest, hn::Neg(most_error)))
            );
            const auto surely_between =
                hn::And(hn::Ge(low, hn::Set(d, ray.t_min)), hn::Le(high, hn::Set(d, limit)));
            out.sure |= bits_of(d, hn::And(surely_inside, surely_between)) << first;
        }
    }
    return out;
}

/// Opens leaves, nearest boxes first when `ordered`, slot by slot otherwise. `open_block(block,
/// reach)` returns whether to go on, and may lower `reach`.
template <bool ordered, class Observer, class OpenBlock>
HWY_INLINE void
traverse(const WideBvh& tree, const WideRay& ray, Observer& seen, OpenBlock&& open_block) {
    // Every node on a path leaves at most width - 1 siblings waiting.
    std::array<std::uint64_t, WideBvh::max_depth*(WideNode::width - 1) + 1> stack;
    std::size_t height = 0;
    float reach_limit = reach(ray.t_max);
    const WideNode* const nodes = tree.nodes.data();
    const TriangleBlock* const blocks = tree.blocks.data();
    WideRef current = WideRef::node(0);

    const auto pop = [&]() HWY_ATTR {
        while (height > 0) {
            const std::uint64_t entry = stack[--height];
            current = WideRef::from_bits(static_cast<std::uint32_t>(entry));
            if constexpr (!ordered) return true;
            if (std::bit_cast<float>(static_cast<std::uint32_t>(entry >> 32U)) <= reach_limit)
                return true;
        }
        return false;
    };

    for (;;) {
        if (current.is_leaf()) {
            seen.leaf(NodeId{});
            const TriangleBlock* block = blocks + current.index();
            for (;;) {
                for (std::size_t i = 0; i < TriangleBlock::width; ++i)
                    seen.prim(block->prims[i]);
                if (!open_block(*block, reach_limit)) return;
                if (block->is_last != 0) break;
                ++block;
            }
            if (!pop()) return;
            continue;
        }
        const WideNode& node = nodes[current.index()];
        seen.inner(NodeId{});
        seen.box_tests(WideNode::width);
        alignas(32) std::array<float, WideNode::width> entries;
        std::uint32_t hits = enter_boxes(ray, node, reach_limit, entries.data());
        if (hits == 0) {
            if (!pop()) return;
            continue;
        }
        const auto next_slot = [&]() HWY_ATTR {
            const auto slot = static_cast<std::size_t>(std::countr_zero(hits));
            hits &= hits - 1;
            return slot;
        };
        const auto entry_of = [&](std::size_t slot) HWY_ATTR {
            const auto order = std::bit_cast<std::uint32_t>(entries[slot]);
            return std::uint64_t{order} << 32U | node.children[slot].bits();
        };
        std::size_t slot = next_slot();
        if (hits == 0) {
            current = node.children[slot];
            continue;
        }
        if constexpr (!ordered) {
            current = node.children[slot];
            do
                stack[height++] = node.children[next_slot()].bits();
            while (hits != 0);
            continue;
        }
        std::uint64_t nearest = entry_of(slot);
        const std::size_t base = height;
        do {
            std::uint64_t entry = entry_of(next_slot());
            const bool is_nearer = entry < nearest;
            const std::uint64_t farther = is_nearer ? nearest : entry;
            nearest = is_nearer ? entry : nearest;
            // Insertion: the farthest lies deepest.
            std::size_t at = height++;
            while (at > base && stack[at - 1] < farther) {
                stack[at] = stack[at - 1];
                --at;
            }
            stack[at] = farther;
        } while (hits != 0);
        current = WideRef::from_bits(static_cast<std::uint32_t>(nearest));
    }
}

/// The hit of one lane in the fast mode.
HWY_INLINE Hit
fast_hit(const Ray& ray, const TriangleBlock& block, const Candidates& found, std::size_t lane) {
    const Triangle triangle = block.triangle(lane);
    const bool front =
        dot(cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0), ray.direction) < 0;
    return {found.t[lane] + 0.0F, found.u[lane], found.v[lane], block.prims[lane], front};
}

template <TraceMode mode, class Observer>
Hit closest(const WideBvh& tree, const Ray& ray, Observer& seen) {
    const std::optional<WideRay> wide = prepare(ray, tree);
    if (!wide) [[unlikely]]
        return closest_scalar(tree, ray);
    Hit best;
    float limit = ray.t_max;
    traverse<true>(tree, *wide, seen, [&](const TriangleBlock& block, float& reach_limit) HWY_ATTR {
        const Candidates found = meet_block<mode>(*wide, block, limit);
        for (std::uint32_t left = found.possible; left != 0; left &= left - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(left));
            if constexpr (mode == TraceMode::fast) {
                const Hit hit = fast_hit(ray, block, found, lane);
                if (!is_closer(hit, best)) continue;
                best = hit;
            } else {
                const auto hit =
                    ExactKernel::decide(ray, block.triangle(lane), block.prims[lane], limit);
                if (!hit || !is_closer(*hit, best)) continue;
                best = *hit;
            }
            limit = best.t;
            reach_limit = reach(limit);
        }
        return true;
    });
    return best;
}

template <TraceMode mode, class Observer>
bool any(const WideBvh& tree, const Ray& ray, Observer& seen) {
    const std::optional<WideRay> wide = prepare(ray, tree);
    if (!wide) [[unlikely]]
        return any_scalar(tree, ray);
    bool is_hit = false;
    traverse<false>(tree, *wide, seen, [&](const TriangleBlock& block, float&) HWY_ATTR {
        const Candidates found = meet_block<mode>(*wide, block, ray.t_max);
        is_hit = found.sure != 0;
        for (std::uint32_t left = found.possible; left != 0 && !is_hit; left &= left - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(left));
            is_hit = ExactKernel::decide(ray, block.triangle(lane), block.prims[lane], ray.t_max)
                         .has_value();
        }
        return !is_hit;
    });
    return is_hit;
}

template <TraceMode mode>
void all(const WideBvh& tree, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    const std::optional<WideRay> wide = prepare(ray, tree);
    if (!wide) [[unlikely]]
        return all_scalar(tree, ray, visit);
    Silent seen;
    traverse<false>(tree, *wide, seen, [&](const TriangleBlock& block, float&) HWY_ATTR {
        const Candidates found = meet_block<mode>(*wide, block, ray.t_max);
        for (std::uint32_t left = found.possible; left != 0; left &= left - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(left));
            if constexpr (mode == TraceMode::fast) {
                visit(fast_hit(ray, block, found, lane));
            } else if (const auto hit = ExactKernel::decide(
                           ray, block.triangle(lane), block.prims[lane], ray.t_max
                       )) {
                visit(*hit);
            }
        }
        return true;
    });
}

template <TraceMode mode>
Hit closest_silent(const WideBvh& tree, const Ray& ray) {
    Silent seen;
    return closest<mode>(tree, ray, seen);
}

template <TraceMode mode>
bool any_silent(const WideBvh& tree, const Ray& ray) {
    Silent seen;
    return any<mode>(tree, ray, seen);
}

template <TraceMode mode>
Hit closest_counted(const WideBvh& tree, const Ray& ray, Counts& counts) {
    return closest<mode>(tree, ray, counts);
}

template <TraceMode mode>
bool any_counted(const WideBvh& tree, const Ray& ray, Counts& counts) {
    return any<mode>(tree, ray, counts);
}

template <TraceMode mode>
void closest_batch(const WideBvh& tree, const Ray* rays, Hit* hits, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        hits[i] = is_valid(rays[i]) ? closest_silent<mode>(tree, rays[i]) : Hit{};
}

template <TraceMode mode>
void any_batch(const WideBvh& tree, const Ray* rays, bool* occluded, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        occluded[i] = is_valid(rays[i]) && any_silent<mode>(tree, rays[i]);
}

template <TraceMode mode>
constexpr WideKernels kernels_of_mode() {
    return {&closest_silent<mode>, &any_silent<mode>, &all<mode>, &closest_counted<mode>, &any_counted<mode>, &closest_batch<mode>, &any_batch<mode>};
}

const WideKernelTable* kernel_table() {
    static constexpr WideKernelTable table{
        kernels_of_mode<TraceMode::watertight>(), kernels_of_mode<TraceMode::fast>()
    };
    return &table;
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace raywise::simd {

HWY_EXPORT(kernel_table);

namespace {

const WideKernelTable& kernels_for(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    const WideKernelTable* const table = HWY_DYNAMIC_DISPATCH(kernel_table)();
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return *table;
}

} // namespace

std::vector<std::string_view> wide_target_names() {
    std::vector<std::string_view> names;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
        names.emplace_back(hwy::TargetName(target));
    return names;
}

const WideKernelTable& wide_kernels_named(std::string_view name) {
    if (name.empty()) return kernels_for(0);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
        if (name == hwy::TargetName(target)) return kernels_for(target);
    throw Error("simd target: this machine has no '" + std::string(name) + "'");
}

} // namespace raywise::simd

#endif
