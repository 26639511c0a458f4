// Which leaves a ray opens, and in which order.
#if defined(RAYWISE_TRACE_SIMD_WIDE_TRAVERSE) ==                                                   \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_TRAVERSE
#undef RAYWISE_TRACE_SIMD_WIDE_TRAVERSE
#else
#define RAYWISE_TRACE_SIMD_WIDE_TRAVERSE
#endif

#include "trace/simd/lanes_of_bits.hpp"
#include "trace/simd/wide_lanes.inl.hpp"
#include "trace/simd/wide_ray.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/ids.hpp>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Where the ray enters boxes, and which it meets at or before a limit.
template <class D>
struct Entries {
    hn::Vec<D> entry;
    hn::Mask<D> is_met;
};

/// Of the lanes of `d` from slot `first` on.
template <class D>
HWY_INLINE Entries<D>
enter_lanes(D d, const WideRay& ray, const WideNode& node, float reach_limit, std::size_t first) {
    const PlaneMaps& maps = ray.planes;
    const auto near = [&](std::size_t axis) HWY_ATTR {
        return hn::MulAdd(
            hn::Load(d, floats_at(&node, maps.near_offset[axis]) + first),
            hn::Set(d, maps.near_scale[axis]),
            hn::Set(d, maps.near_shift[axis])
        );
    };
    const auto far = [&](std::size_t axis) HWY_ATTR {
        return hn::MulAdd(
            hn::Load(d, floats_at(&node, maps.far_offset[axis]) + first),
            hn::Set(d, maps.far_scale[axis]),
            hn::Set(d, maps.far_shift[axis])
        );
    };
    const auto entry = hn::Max(hn::Max(near(0), near(1)), hn::Max(near(2), hn::Set(d, ray.t_min)));
    const auto exit = hn::Min(hn::Min(far(0), far(1)), hn::Min(far(2), hn::Set(d, reach_limit)));
    return {entry, hn::Le(entry, exit)};
}

#if HWY_MAX_BYTES >= 32

HWY_INLINE Entries<Eight> enter_boxes(const WideRay& ray, const WideNode& node, float reach_limit) {
    return enter_lanes(Eight(), ray, node, reach_limit, 0);
}

#else

/// Bit i of the result: the ray meets box i.
HWY_INLINE std::uint32_t enter_boxes(
    const WideRay& ray,
    const WideNode& node,
    float reach_limit,
    float* HWY_RESTRICT entries
) {
    const Eight d;
    std::uint32_t hits = 0;
    for (std::size_t first = 0; first < WideNode::width; first += hn::Lanes(d)) {
        const auto [entry, is_met] = enter_lanes(d, ray, node, reach_limit, first);
        hn::Store(entry, d, entries + first);
        hits |= bits_of(d, is_met) << first;
    }
    return hits;
}

#endif

// Every node on a path leaves at most width - 1 siblings waiting, and writes a vector.
constexpr std::size_t stack_capacity =
    WideBvh::max_depth * (WideNode::width - 1) + 1 + WideNode::width;

/// Reference of the entry below all others: the traversal ends.
constexpr std::uint32_t done = 0xFFFFFFFFU;

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

using EightKeys = hn::RebindToUnsigned<Eight>;
using Keys = hn::Vec<EightKeys>;
using Lanes = hn::Vec<Eight>;

/// The lanes whose bits are set, in order, then any.
HWY_INLINE Keys compressed(Keys v, std::uint32_t bits) {
    const EightKeys d;
#if HWY_TARGET == HWY_AVX3
    const std::uint8_t byte = static_cast<std::uint8_t>(bits);
    return hn::Compress(v, hn::LoadMaskBits(d, &byte));
#else
    // Highway's own table is copied to the stack at every use by g++ 12.
    const hn::Rebind<std::uint8_t, EightKeys> bytes;
    const auto order = hn::PromoteTo(d, hn::LoadU(bytes, lanes_of_bits[bits].data()));
    return hn::TableLookupLanes(v, hn::IndicesFromVec(d, order));
#endif
}

/// By falling value: a bitonic network without branches. [Batcher68]
HWY_INLINE Keys sorted_down(Keys v) {
    const EightKeys d;
    const hn::Repartition<std::uint64_t, EightKeys> pairs;
    const auto greater_first = [&](Keys turned) HWY_ATTR {
        return hn::OddEven(hn::Min(v, turned), hn::Max(v, turned));
    };
    const auto greater_pair_first = [&](Keys turned) HWY_ATTR {
        return hn::BitCast(
            d,
            hn::OddEven(
                hn::BitCast(pairs, hn::Min(v, turned)), hn::BitCast(pairs, hn::Max(v, turned))
            )
        );
    };
    v = greater_first(hn::Shuffle2301(v));
    v = greater_pair_first(hn::Shuffle0123(v));
    v = greater_first(hn::Shuffle2301(v));
    const Keys turned = hn::Reverse(d, v);
    v = hn::ConcatUpperLower(d, hn::Min(v, turned), hn::Max(v, turned));
    v = greater_pair_first(hn::Shuffle1032(v));
    return greater_first(hn::Shuffle2301(v));
}

/// Nodes and leaves that wait. A key is where the ray enters a box, with the slot in the lowest
/// bits.
struct Stack {
    std::array<std::uint32_t, stack_capacity> refs;
    std::array<std::uint32_t, stack_capacity> keys;
};

/// Drops what is entered beyond the limit; returns the new height.
HWY_INLINE std::size_t drop_beyond(Stack& stack, std::size_t height, float reach_limit) {
    const EightKeys d;
    const Eight floats;
    std::size_t kept = 1;
    for (std::size_t i = 1; i < height; i += WideNode::width) {
        const Keys keys = hn::LoadU(d, stack.keys.data() + i);
        const Keys refs = hn::LoadU(d, stack.refs.data() + i);
        const auto entry = hn::BitCast(floats, hn::AndNot(hn::Set(d, 7U), keys));
        const auto is_near = hn::And(
            hn::RebindMask(d, hn::Le(entry, hn::Set(floats, reach_limit))),
            hn::FirstN(d, height - i)
        );
        // What this overwrites has been read.
        const std::uint32_t bits = bits_of(d, is_near);
        hn::StoreU(compressed(keys, bits), d, stack.keys.data() + kept);
        hn::StoreU(compressed(refs, bits), d, stack.refs.data() + kept);
        kept += static_cast<std::size_t>(std::popcount(bits));
    }
    return kept;
}

/// The first node and the first block, by WideRef::is_leaf.
using Bases = std::array<const void*, 2>;

HWY_INLINE const std::byte* address_of(const Bases& bases, WideRef ref) {
    return static_cast<const std::byte*>(bases[ref.is_leaf() ? 1 : 0]) + ref.words() * 8;
}

/// Asks for all of what will be opened later.
HWY_INLINE void prefetch(const Bases& bases, WideRef ref) {
    // Past the end for the last entry of the stack: a prefetch does not mind.
    const std::byte* const at = address_of(bases, ref);
    constexpr std::size_t line = 64;
    for (std::size_t i = 0; i < sizeof(WideNode); i += line)
        hwy::Prefetch(at + i);
}

/// Opens leaves, nearest boxes first when `ordered`, the last slots first otherwise.
/// `open_block(block, reach)` returns whether to go on, and may lower `reach`. The only branches on
/// what a node's boxes say are whether none is met and whether one is, where a right guess spares
/// a wait: which they are and how many more is what no predictor guesses, and a wrong guess costs
/// more than a sorting network.
template <bool ordered, class Observer, class OpenBlock>
HWY_INLINE void
traverse(const WideBvh& tree, const WideRay& ray, Observer& seen, OpenBlock&& open_block) {
    const Eight d;
    const EightKeys dk;
    // Whole numbers are compared sooner than floats, and alike: entries are not below t_min >= +0,
    // boxes with an exit below that are missed however far below, and no box with a hit has -0.
    const hn::RebindToSigned<Eight> di;
    const auto near_scale_x = hn::Set(d, ray.planes.near_scale[0]);
    const auto near_scale_y = hn::Set(d, ray.planes.near_scale[1]);
    const auto near_scale_z = hn::Set(d, ray.planes.near_scale[2]);
    const auto near_shift_x = hn::Set(d, ray.planes.near_shift[0]);
    const auto near_shift_y = hn::Set(d, ray.planes.near_shift[1]);
    const auto near_shift_z = hn::Set(d, ray.planes.near_shift[2]);
    const auto far_scale_x = hn::Set(d, ray.planes.far_scale[0]);
    const auto far_scale_y = hn::Set(d, ray.planes.far_scale[1]);
    const auto far_scale_z = hn::Set(d, ray.planes.far_scale[2]);
    const auto far_shift_x = hn::Set(d, ray.planes.far_shift[0]);
    const auto far_shift_y = hn::Set(d, ray.planes.far_shift[1]);
    const auto far_shift_z = hn::Set(d, ray.planes.far_shift[2]);
    const auto t_min = hn::BitCast(di, hn::Set(d, ray.t_min));
    // Of the first node: what a reference adds is the same for all of these.
    const WideNode* const nodes = tree.nodes.data();
    const float* const near_x = floats_at(nodes, ray.planes.near_offset[0]);
    const float* const near_y = floats_at(nodes, ray.planes.near_offset[1]);
    const float* const near_z = floats_at(nodes, ray.planes.near_offset[2]);
    const float* const far_x = floats_at(nodes, ray.planes.far_offset[0]);
    const float* const far_y = floats_at(nodes, ray.planes.far_offset[1]);
    const float* const far_z = floats_at(nodes, ray.planes.far_offset[2]);
    const auto* const first_children =
        reinterpret_cast<const std::uint32_t*>(nodes->children.data());
    const Bases bases{nodes, tree.blocks.data()};

    Stack stack; // NOLINT(*-member-init): written before read
    std::size_t height = 1;
    stack.refs[0] = done;
    float reach_limit = reach(ray.t_max);
    std::uint32_t current = WideRef::node(0).bits();
    for (;;) {
        const auto reach_lanes = hn::BitCast(di, hn::Set(d, reach_limit));
        while (!WideRef::from_bits(current).is_leaf()) {
            seen.inner(NodeId{});
            seen.box_tests(WideNode::width);
            // In floats, as the pointers are; a node's bits are its words.
            const std::size_t at = 2 * std::size_t{current};
            const auto meet = [&](const float* planes, Lanes scale, Lanes shift) HWY_ATTR {
                return hn::BitCast(di, hn::MulAdd(hn::Load(d, planes + at), scale, shift));
            };
            const auto entry = hn::Max(
                hn::Max(
                    meet(near_x, near_scale_x, near_shift_x),
                    meet(near_y, near_scale_y, near_shift_y)
                ),
                hn::Max(meet(near_z, near_scale_z, near_shift_z), t_min)
            );
            const auto exit = hn::Min(
                hn::Min(
                    meet(far_x, far_scale_x, far_shift_x), meet(far_y, far_scale_y, far_shift_y)
                ),
                hn::Min(meet(far_z, far_scale_z, far_shift_z), reach_lanes)
            );
            const auto is_met = hn::RebindMask(dk, hn::Gt(exit, entry));
            const std::uint32_t hits = bits_of(dk, is_met);
            const auto count = static_cast<std::size_t>(std::popcount(hits));
            const std::uint32_t* const children = first_children + at;
            const Keys refs = hn::Load(dk, children);
            if (hits == 0) {
                current = stack.refs[--height];
                continue;
            }
            // A branch of its own, whose next node waits for no minimum of eight.
            if (ordered && (hits & (hits - 1)) == 0) {
                current = children[hwy::Num0BitsBelowLS1Bit_Nonzero32(hits)];
                prefetch(bases, WideRef::from_bits(stack.refs[height - 1]));
                continue;
            }
            std::uint32_t next = 0;
            if constexpr (ordered) {
                const Keys key =
                    hn::Or(hn::AndNot(hn::Set(dk, 7U), hn::BitCast(dk, entry)), hn::Iota(dk, 0));
                const auto child_at = [&](Keys keys) HWY_ATTR {
                    const auto slots = hn::IndicesFromVec(dk, hn::And(keys, hn::Set(dk, 7U)));
                    return hn::TableLookupLanes(refs, slots);
                };
                const Keys nearest =
                    hn::MinOfLanes(dk, hn::IfThenElse(is_met, key, hn::Set(dk, 0xFFFFFFFFU)));
                next = hn::GetLane(child_at(nearest));
                const Keys sorted = sorted_down(hn::IfThenElseZero(is_met, key));
                hn::StoreU(sorted, dk, stack.keys.data() + height);
                hn::StoreU(child_at(sorted), dk, stack.refs.data() + height);
            } else {
                hn::StoreU(compressed(refs, hits), dk, stack.refs.data() + height);
                next = children[31 ^ hwy::Num0BitsAboveMS1Bit_Nonzero32(hits)];
            }
            // The last one pushed is next; the one below it most likely after that.
            height += count - 1;
            current = next;
            prefetch(bases, WideRef::from_bits(stack.refs[height - 1]));
        }
        if (current == done) return;
        // One block at a time, for a loop of its own would have all registers saved around it.
        const WideRef ref = WideRef::from_bits(current);
        const auto& block = *reinterpret_cast<const TriangleBlock*>(address_of(bases, ref));
        for (std::size_t i = 0; i < TriangleBlock::width; ++i)
            seen.prim(block.prims[i]);
        const float old_reach = reach_limit;
        const bool goes_on = open_block(block, reach_limit);
        const bool is_last = block.is_last != 0;
        if (is_last || !goes_on) seen.leaf(NodeId{});
        if (!goes_on) return;
        // Dropped now, so that no pop has to ask.
        if (ordered && reach_limit < old_reach) height = drop_beyond(stack, height, reach_limit);
        if (!is_last) {
            current = ref.next_block().bits();
            continue;
        }
        current = stack.refs[--height];
    }
}

#else

/// Opens leaves, nearest boxes first when `ordered`, the last slots first otherwise.
/// `open_block(block, reach)` returns whether to go on, and may lower `reach`.
template <bool ordered, class Observer, class OpenBlock>
HWY_INLINE void
traverse(const WideBvh& tree, const WideRay& ray, Observer& seen, OpenBlock&& open_block) {
    struct Waiting {
        std::uint32_t ref;
        float entry;
    };

    std::array<Waiting, stack_capacity> stack; // NOLINT(*-member-init): written before read
    std::size_t height = 0;
    stack[height++] = {WideRef::node(0).bits(), 0};
    float reach_limit = reach(ray.t_max);
    while (height > 0) {
        const auto [bits, nearest] = stack[--height];
        if (ordered && nearest > reach_limit) continue;
        const WideRef current = WideRef::from_bits(bits);
        if (current.is_leaf()) {
            seen.leaf(NodeId{});
            const TriangleBlock* block = tree.blocks.data() + current.index();
            for (;; ++block) {
                for (std::size_t i = 0; i < TriangleBlock::width; ++i)
                    seen.prim(block->prims[i]);
                if (!open_block(*block, reach_limit)) return;
                if (block->is_last != 0) break;
            }
            continue;
        }
        seen.inner(NodeId{});
        seen.box_tests(WideNode::width);
        const WideNode& node = tree.nodes[current.index()];
        alignas(16) std::array<float, WideNode::width> entries;
        std::uint32_t hits = enter_boxes(ray, node, reach_limit, entries.data());
        const std::size_t base = height;
        for (; hits != 0; hits &= hits - 1) {
            const auto slot = static_cast<std::size_t>(std::countr_zero(hits));
            std::size_t at = height++;
            // Insertion: the farthest lies deepest.
            while (ordered && at > base && stack[at - 1].entry < entries[slot]) {
                stack[at] = stack[at - 1];
                --at;
            }
            stack[at] = {node.children[slot].bits(), entries[slot]};
        }
    }
}

#endif

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
