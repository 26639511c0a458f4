// What groups of rays do with blocks of triangles, and batches by groups.
#if defined(RAYWISE_TRACE_SIMD_WIDE_GROUP_QUERY) ==                                                \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_GROUP_QUERY
#undef RAYWISE_TRACE_SIMD_WIDE_GROUP_QUERY
#else
#define RAYWISE_TRACE_SIMD_WIDE_GROUP_QUERY
#endif

#include "trace/simd/wide_block.inl.hpp"
#include "trace/simd/wide_group.inl.hpp"
#include "trace/simd/wide_group_settle.inl.hpp"
#include "trace/simd/wide_group_traverse.inl.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/wide.hpp>

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The rays of a group and one triangle of a block.
HWY_INLINE Encounter<Many> encounter(
    const RayGroup& group,
    const TriangleBlock& block,
    std::size_t lane,
    RayMask rays,
    RayLanes t_max
) {
    const Many d;
    const auto sheared = [&](std::size_t vertex) HWY_ATTR {
        const auto seen = [&](std::size_t i) HWY_ATTR {
            const float coordinate = block.vertices[vertex][group.axes[i]][lane];
            return hn::Sub(hn::Set(d, coordinate), group.origin[i].load());
        };
        const RayLanes z = seen(2);
        return ShearedVertex<Many>{
            hn::NegMulAdd(group.shear[0].load(), z, seen(0)),
            hn::NegMulAdd(group.shear[1].load(), z, seen(1)),
            z
        };
    };
    const hn::RebindToUnsigned<Many> du;
    const auto prim = hn::Set(du, static_cast<std::uint32_t>(block.prims[lane]));
    const auto is_other = hn::Ne(hn::BitCast(du, group.excluded.load()), prim);
    return {
        sheared(0),
        sheared(1),
        sheared(2),
        hn::Set(d, block.doubled_extents[lane]),
        group.shear[2].load(),
        group.t_min.load(),
        t_max,
        hn::And(rays, hn::RebindMask(d, is_other))
    };
}

/// The rays whose bits are set.
HWY_INLINE RayMask mask_of(std::uint32_t bits) {
    const std::array<std::uint8_t, 8> bytes{
        static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8U)
    };
    return hn::LoadMaskBits(Many(), bytes.data());
}

/// `reach` of every lane.
HWY_INLINE RayLanes reach_lanes(RayLanes t) {
    const Many d;
    return hn::MulAdd(t, hn::Set(d, 1 + 16 * unit_roundoff), hn::Set(d, 0x1p-120F));
}

/// The nearest sure hits of a group, as Nearest has it of one ray.
template <TraceMode mode>
class GroupNearest {
public:
    HWY_INLINE explicit GroupNearest(const RayGroup& group) : group_(group) {
        const Many d;
        limit_.store(group.t_max.load());
        reach_.store(reach_lanes(group.t_max.load()));
        low_.store(hn::Set(d, std::numeric_limits<float>::infinity()));
        prims_.store(hn::BitCast(d, hn::Set(Ids(), static_cast<std::uint32_t>(no_prim))));
        if constexpr (mode == TraceMode::fast) {
            u_.store(hn::Zero(d));
            v_.store(hn::Zero(d));
        }
        measure_farthest();
    }

    [[nodiscard]] HWY_INLINE RayLanes reach() const { return reach_.load(); }

    [[nodiscard]] HWY_INLINE float farthest() const { return farthest_; }

    HWY_INLINE void open(const TriangleBlock& block, RayMask rays) {
        for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane) {
            if (block.prims[lane] == no_prim) break;
            Meeting<Many> found;
            if (meet<mode>(Many(), encounter(group_, block, lane, rays, limit_.load()), found))
                take(block, lane, found);
        }
    }

    HWY_INLINE void leave(std::uint32_t bits) {
        const Many d;
        open_ |= bits;
        reach_.store(hn::IfThenElse(mask_of(bits), hn::Set(d, -1.0F), reach_.load()));
        measure_farthest();
    }

    /// Writes the answers; returns the bits of the rays that have none yet.
    HWY_INLINE std::uint32_t answer(const Ray* rays, Hit* hits) const {
        std::fill_n(hits, group_size, Hit{});
        const std::uint32_t known = taken_ & ~open_;
        if (known == 0) return open_;
        GroupHits found;
        if constexpr (mode == TraceMode::fast)
            found = {limit_, u_, v_, fronts(rays), known};
        else
            settle_group(questions(rays), found);
        for (std::uint32_t left = known; left != 0; left &= left - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(left));
            hits[i] = {
                found.t.items[i],
                found.u.items[i],
                found.v.items[i],
                blocks_[i]->prims[lanes_[i]],
                (found.is_front >> i & 1U) != 0
            };
        }
        return open_ | (known & ~found.is_settled);
    }

private:
    using Ids = hn::RebindToUnsigned<Many>;

    /// Takes the triangle where it is surely nearer than all before.
    HWY_INLINE void take(const TriangleBlock& block, std::size_t lane, const Meeting<Many>& found) {
        const Many d;
        const auto prim = hn::Set(Ids(), static_cast<std::uint32_t>(block.prims[lane]));
        const auto taken_prims = hn::BitCast(Ids(), prims_.load());
        RayMask is_taken;
        if constexpr (mode == TraceMode::fast) {
            const RayLanes t = hn::Add(found.low, hn::Zero(d));
            const auto is_before = hn::RebindMask(d, hn::Lt(prim, taken_prims));
            is_taken = hn::And(
                found.possible,
                hn::Or(hn::Lt(t, limit_.load()), hn::And(hn::Eq(t, limit_.load()), is_before))
            );
            u_.store(hn::IfThenElse(is_taken, found.u, u_.load()));
            v_.store(hn::IfThenElse(is_taken, found.v, v_.load()));
        } else {
            is_taken = hn::And(found.sure, hn::Lt(found.high, low_.load()));
            // Often the same triangle, of another leaf.
            const auto is_same = hn::RebindMask(d, hn::Eq(prim, taken_prims));
            const auto is_open = hn::AndNot(hn::Or(is_taken, is_same), found.possible);
            open_ |= bits_of(d, is_open);
            low_.store(hn::IfThenElse(is_taken, found.low, low_.load()));
        }
        std::uint32_t taken = bits_of(d, is_taken);
        if (taken == 0) return;
        taken_ |= taken;
        limit_.store(hn::IfThenElse(is_taken, found.high, limit_.load()));
        reach_.store(hn::IfThenElse(is_taken, reach_lanes(found.high), reach_.load()));
        prims_.store(hn::IfThenElse(is_taken, hn::BitCast(d, prim), prims_.load()));
        for (; taken != 0; taken &= taken - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(taken));
            blocks_[i] = &block;
            lanes_[i] = static_cast<std::uint8_t>(lane);
        }
        measure_farthest();
    }

    /// Where a ray hit nothing, of a triangle without area.
    HWY_INLINE GroupQuestions questions(const Ray* rays) const {
        GroupQuestions asked{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t offset = axis * sizeof(float);
            asked.origin[axis].store(gathered(rays, offsetof(Ray, origin) + offset));
            asked.direction[axis].store(gathered(rays, offsetof(Ray, direction) + offset));
        }
        for (std::uint32_t left = taken_; left != 0; left &= left - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(left));
            const TriangleBlock& block = *blocks_[i];
            for (std::size_t vertex = 0; vertex < 3; ++vertex)
                for (std::size_t axis = 0; axis < 3; ++axis)
                    asked.vertices[vertex][axis].items[i] = block.vertices[vertex][axis][lanes_[i]];
            asked.doubled_extent.items[i] = block.doubled_extents[lanes_[i]];
        }
        asked.most_t = limit_;
        asked.largest = group_.largest;
        return asked;
    }

    /// Bits: the ray sees the triangle's front, by float arithmetic.
    HWY_INLINE std::uint32_t fronts(const Ray* rays) const {
        std::uint32_t bits = 0;
        for (std::uint32_t left = taken_; left != 0; left &= left - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(left));
            const auto [v0, v1, v2] = blocks_[i]->triangle(lanes_[i]);
            if (dot(cross(v1 - v0, v2 - v0), rays[i].direction) < 0) bits |= 1U << i;
        }
        return bits;
    }

    HWY_INLINE void measure_farthest() {
        farthest_ = hn::GetLane(hn::MaxOfLanes(Many(), reach_.load()));
    }

    const RayGroup& group_;
    PerRay limit_, reach_, low_; // t of what is taken is at least low and at most limit
    PerRay u_, v_;               // of the fast mode
    PerRay prims_;               // as bits
    std::array<const TriangleBlock*, group_size> blocks_;
    std::array<std::uint8_t, group_size> lanes_;
    std::uint32_t taken_ = 0; // rays that a block and a lane are known of
    std::uint32_t open_ = 0;  // rays that met what the filter does not decide, or that left
    float farthest_ = 0;
};

/// Which rays of a group are surely hit, and which may be.
template <TraceMode mode>
class GroupAny {
public:
    HWY_INLINE explicit GroupAny(const RayGroup& group) : group_(group) {
        reach_.store(reach_lanes(group.t_max.load()));
        measure_farthest();
    }

    [[nodiscard]] HWY_INLINE RayLanes reach() const { return reach_.load(); }

    [[nodiscard]] HWY_INLINE float farthest() const { return farthest_; }

    HWY_INLINE void open(const TriangleBlock& block, RayMask rays) {
        const Many d;
        RayMask left = rays;
        for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane) {
            if (block.prims[lane] == no_prim) break;
            Meeting<Many> found;
            if (!meet<mode>(d, encounter(group_, block, lane, left, group_.t_max.load()), found))
                continue;
            hit_ |= bits_of(d, found.sure);
            open_ |= bits_of(d, found.possible);
            left = hn::AndNot(found.sure, left);
            reach_.store(hn::IfThenElse(found.sure, hn::Set(d, -1.0F), reach_.load()));
        }
        measure_farthest();
    }

    HWY_INLINE void leave(std::uint32_t bits) {
        const Many d;
        open_ |= bits;
        reach_.store(hn::IfThenElse(mask_of(bits), hn::Set(d, -1.0F), reach_.load()));
        measure_farthest();
    }

    /// Writes the answers; returns the bits of the rays that have none yet.
    HWY_INLINE std::uint32_t answer(bool* occluded) const {
        for (std::size_t i = 0; i < group_size; ++i)
            occluded[i] = (hit_ >> i & 1U) != 0;
        return open_ & ~hit_;
    }

private:
    HWY_INLINE void measure_farthest() {
        farthest_ = hn::GetLane(hn::MaxOfLanes(Many(), reach_.load()));
    }

    const RayGroup& group_;
    PerRay reach_;
    std::uint32_t hit_ = 0;
    std::uint32_t open_ = 0;
    float farthest_ = 0;
};

/// Answers the next group_size rays as far as they go together; returns the bits of the others.
template <TraceMode mode>
HWY_NOINLINE std::uint32_t closest_of_group(const WideBvh& tree, const Ray* rays, Hit* hits) {
    RayGroup group; // NOLINT(*-member-init): prepare_group fills it
    if (!prepare_group(rays, tree, group)) return all_of_group;
    GroupNearest<mode> query(group);
    traverse_group<true>(tree, group, query);
    return query.answer(rays, hits);
}

template <TraceMode mode>
HWY_NOINLINE std::uint32_t any_of_group(const WideBvh& tree, const Ray* rays, bool* occluded) {
    RayGroup group; // NOLINT(*-member-init): prepare_group fills it
    if (!prepare_group(rays, tree, group)) return all_of_group;
    GroupAny<mode> query(group);
    traverse_group<false>(tree, group, query);
    return query.answer(occluded);
}

/// `group(first)` answers rays that stand together and returns the bits of those that it does not,
/// for `single(i)` to answer. Where most are left, fewer groups are tried.
template <class Group, class Single>
HWY_INLINE void by_groups(std::size_t count, const Group& group, const Single& single) {
    constexpr std::size_t most_skipped = 8;
    constexpr int most_left = static_cast<int>(group_size) / 2;
    std::size_t skipped = 0, to_skip = 0, first = 0;
    for (; first + group_size <= count; first += group_size) {
        std::uint32_t left = all_of_group;
        if (to_skip > 0) {
            --to_skip;
        } else {
            left = group(first);
            if (std::popcount(left) <= most_left)
                skipped = 0;
            else
                skipped = to_skip = std::min(2 * skipped + 1, most_skipped);
        }
        for (; left != 0; left &= left - 1)
            single(first + static_cast<std::size_t>(std::countr_zero(left)));
    }
    for (; first < count; ++first)
        single(first);
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
