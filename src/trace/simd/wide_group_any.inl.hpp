// Which rays of a group are hit at all.
#if defined(RAYWISE_TRACE_SIMD_WIDE_GROUP_ANY) ==                                                  \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_GROUP_ANY
#undef RAYWISE_TRACE_SIMD_WIDE_GROUP_ANY
#else
#define RAYWISE_TRACE_SIMD_WIDE_GROUP_ANY
#endif

#include "trace/simd/wide_block.inl.hpp"
#include "trace/simd/wide_group.inl.hpp"
#include "trace/simd/wide_group_block.inl.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/trace/wide.hpp>

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Which rays of a group are surely hit, and which may be.
template <TraceMode mode>
class GroupAny {
public:
    HWY_INLINE explicit GroupAny(const RayGroup& group)
        : group_(group), reach_(group.t_max.load()) {}

    [[nodiscard]] HWY_INLINE RayLanes reach() const { return reach_.lanes(); }

    [[nodiscard]] HWY_INLINE float farthest() const { return reach_.farthest(); }

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
        }
        reach_.end(hn::AndNot(left, rays));
    }

    HWY_INLINE void leave(std::uint32_t bits) {
        open_ |= bits;
        reach_.end(mask_of(bits));
    }

    /// Writes the answers; returns the bits of the rays that have none yet.
    HWY_INLINE std::uint32_t answer(bool* occluded) const {
        for (std::size_t i = 0; i < group_size; ++i)
            occluded[i] = (hit_ >> i & 1U) != 0;
        return open_ & ~hit_;
    }

private:
    const RayGroup& group_;
    GroupReach reach_;
    std::uint32_t hit_ = 0;
    std::uint32_t open_ = 0;
};

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
