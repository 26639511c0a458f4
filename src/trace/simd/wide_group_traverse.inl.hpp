// Which leaves a group of rays opens together. After [Reshetov05], [Overbeck08].
#if defined(RAYWISE_TRACE_SIMD_WIDE_GROUP_TRAVERSE) ==                                             \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_GROUP_TRAVERSE
#undef RAYWISE_TRACE_SIMD_WIDE_GROUP_TRAVERSE
#else
#define RAYWISE_TRACE_SIMD_WIDE_GROUP_TRAVERSE
#endif

#include "trace/simd/wide_group.inl.hpp"
#include "trace/simd/wide_lanes.inl.hpp"
#include "trace/simd/wide_traverse.inl.hpp"

#include <raywise/bvh/wide_bvh.hpp>

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The rays that meet the box of a slot at or before their reach.
HWY_INLINE RayMask
meet_slot(const RayGroup& group, const WideNode& node, std::size_t slot, RayLanes reach) {
    const auto near = [&](std::size_t axis) HWY_ATTR {
        return group.near[axis].at(floats_at(&node, group.near_offset[axis])[slot]);
    };
    const auto far = [&](std::size_t axis) HWY_ATTR {
        return group.far[axis].at(floats_at(&node, group.far_offset[axis])[slot]);
    };
    const auto entry = hn::Max(hn::Max(near(0), near(1)), hn::Max(near(2), group.t_min.load()));
    const auto exit = hn::Min(hn::Min(far(0), far(1)), hn::Min(far(2), reach));
    return hn::Le(entry, exit);
}

/// Where no ray enters boxes before, and which of them one may meet at or before `reach`.
HWY_INLINE Entries<Eight> enter_together(const RayGroup& group, const WideNode& node, float reach) {
    const Eight d;
    const auto near = [&](std::size_t axis) HWY_ATTR {
        const auto planes = hn::Load(d, floats_at(&node, group.near_offset[axis]));
        const GroupBound& bound = group.near_bound[axis];
        return hn::Min(bound.on_first(planes), bound.on_second(planes));
    };
    const auto far = [&](std::size_t axis) HWY_ATTR {
        const auto planes = hn::Load(d, floats_at(&node, group.far_offset[axis]));
        const GroupBound& bound = group.far_bound[axis];
        return hn::Max(bound.on_first(planes), bound.on_second(planes));
    };
    const auto entry =
        hn::Max(hn::Max(near(0), near(1)), hn::Max(near(2), hn::Set(d, group.least_t_min)));
    const auto exit = hn::Min(hn::Min(far(0), far(1)), hn::Min(far(2), hn::Set(d, reach)));
    return {entry, hn::Le(entry, exit)};
}

/// Boxes that wait to be compared with every ray: the node's reference, with the slot in the bits
/// that it leaves.
using GroupStack = std::array<std::uint32_t, stack_capacity>;

/// Puts the boxes of a node that some ray may meet on the stack, the nearest last when `ordered`;
/// returns the new height.
template <bool ordered>
HWY_INLINE std::size_t push_slots(
    const RayGroup& group,
    const WideNode& node,
    WideRef ref,
    float reach,
    GroupStack& stack,
    std::size_t height
) {
    const EightKeys d;
    const auto [entry, is_met] = enter_together(group, node, reach);
    const auto is_met_key = hn::RebindMask(d, is_met);
    Keys slots = hn::Iota(d, 0);
    if constexpr (ordered) {
        const Keys key = hn::Or(hn::AndNot(hn::Set(d, 7U), hn::BitCast(d, entry)), slots);
        slots = hn::And(sorted_down(hn::IfThenElseZero(is_met_key, key)), hn::Set(d, 7U));
    } else {
        slots = compressed(slots, bits_of(d, is_met_key));
    }
    hn::StoreU(hn::Or(slots, hn::Set(d, ref.bits())), d, stack.data() + height);
    return height + static_cast<std::size_t>(std::popcount(bits_of(d, is_met_key)));
}

/// How often each ray of a group may meet a box that hardly any other meets: who goes elsewhere had
/// better go alone at once.
class Patience {
public:
    HWY_INLINE Patience() { left_.fill(most); }

    /// Bits of the rays that lose it on the way to a box that only `rays` meet.
    HWY_INLINE std::uint32_t lost_by(std::uint32_t rays) {
        if (std::popcount(rays) > few) return 0;
        std::uint32_t lost = 0;
        for (; rays != 0; rays &= rays - 1)
            if (--left_[static_cast<std::size_t>(std::countr_zero(rays))] == 0)
                lost |= rays & (0U - rays);
        return lost;
    }

private:
    static constexpr int few = 2;
    static constexpr std::int8_t most = 3;

    std::array<std::int8_t, group_size> left_;
};

/// Opens leaves for the rays of the group that meet them, as long as those have much in common.
/// `query.reach()`: of each ray, below 0 for those that are done; `query.farthest()`: the greatest;
/// `query.open(block, rays)`: for each block of a leaf; `query.leave(bits)`: rays that are to go
/// alone, whatever was found for them.
template <bool ordered, class Query>
HWY_INLINE void traverse_group(const WideBvh& tree, const RayGroup& group, Query& query) {
    const Many d;
    const WideNode* const nodes = tree.nodes.data();
    const auto node_at = [&](std::uint32_t words) HWY_ATTR -> const WideNode& {
        return *reinterpret_cast<const WideNode*>(
            reinterpret_cast<const std::byte*>(nodes) + std::size_t{words} * 8
        );
    };
    // A step of a group costs about as much as one of this many rays alone.
    constexpr int rays_per_step = 3;
    int credit = 24 * rays_per_step;
    Patience patience;
    GroupStack stack; // NOLINT(*-member-init): written before read
    std::size_t height =
        push_slots<ordered>(group, nodes[0], WideRef::node(0), query.farthest(), stack, 0);
    while (height > 0 && query.farthest() >= 0) {
        const std::uint32_t waiting = stack[--height];
        const std::size_t slot = waiting & 7U;
        const WideNode& parent = node_at(waiting & ~7U);
        const RayMask rays = meet_slot(group, parent, slot, query.reach());
        const std::uint32_t bits = bits_of(d, rays);
        credit += std::popcount(bits) - rays_per_step;
        if (credit < 0) return query.leave(all_of_group);
        if (bits == 0) continue;
        if (const std::uint32_t lost = patience.lost_by(bits); lost != 0) {
            query.leave(lost);
            if (lost == bits) continue;
        }
        const WideRef child = parent.children[slot];
        if (!child.is_leaf()) {
            height = push_slots<ordered>(
                group, node_at(child.bits()), child, query.farthest(), stack, height
            );
            continue;
        }
        const auto* block = reinterpret_cast<const TriangleBlock*>(
            reinterpret_cast<const std::byte*>(tree.blocks.data()) + child.words() * 8
        );
        for (;; ++block) {
            query.open(*block, rays);
            if (block->is_last != 0) break;
        }
    }
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
