// The closest hits of a group of rays.
#if defined(RAYWISE_TRACE_SIMD_WIDE_GROUP_NEAREST) ==                                              \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_GROUP_NEAREST
#undef RAYWISE_TRACE_SIMD_WIDE_GROUP_NEAREST
#else
#define RAYWISE_TRACE_SIMD_WIDE_GROUP_NEAREST
#endif

#include "trace/simd/wide_block.inl.hpp"
#include "trace/simd/wide_group.inl.hpp"
#include "trace/simd/wide_group_block.inl.hpp"
#include "trace/simd/wide_group_settle.inl.hpp"

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

/// The nearest sure hits of a group, as Nearest has it of one ray.
template <TraceMode mode>
class GroupNearest {
public:
    HWY_INLINE explicit GroupNearest(const RayGroup& group)
        : group_(group), reach_(group.t_max.load()) {
        const Many d;
        limit_.store(group.t_max.load());
        low_.store(hn::Set(d, std::numeric_limits<float>::infinity()));
        prims_.store(hn::BitCast(d, hn::Set(Ids(), static_cast<std::uint32_t>(no_prim))));
        if constexpr (mode == TraceMode::fast) {
            u_.store(hn::Zero(d));
            v_.store(hn::Zero(d));
        }
    }

    [[nodiscard]] HWY_INLINE RayLanes reach() const { return reach_.lanes(); }

    [[nodiscard]] HWY_INLINE float farthest() const { return reach_.farthest(); }

    HWY_INLINE void open(const TriangleBlock& block, RayMask rays) {
        for (std::size_t lane = 0; lane < TriangleBlock::width; ++lane) {
            if (block.prims[lane] == no_prim) break;
            Meeting<Many> found;
            if (meet<mode>(Many(), encounter(group_, block, lane, rays, limit_.load()), found))
                take(block, lane, found);
        }
    }

    HWY_INLINE void leave(std::uint32_t bits) {
        open_ |= bits;
        reach_.end(mask_of(bits));
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
        reach_.shorten(is_taken, found.high);
        prims_.store(hn::IfThenElse(is_taken, hn::BitCast(d, prim), prims_.load()));
        for (; taken != 0; taken &= taken - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(taken));
            blocks_[i] = &block;
            lanes_[i] = static_cast<std::uint8_t>(lane);
        }
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

    const RayGroup& group_;
    GroupReach reach_;
    PerRay limit_, low_; // t of what is taken is at least low and at most limit
    PerRay u_, v_;       // of the fast mode
    PerRay prims_;       // as bits
    std::array<const TriangleBlock*, group_size> blocks_;
    std::array<std::uint8_t, group_size> lanes_;
    std::uint32_t taken_ = 0; // rays that a block and a lane are known of
    std::uint32_t open_ = 0;  // rays that met what the filter does not decide, or that left
};

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
