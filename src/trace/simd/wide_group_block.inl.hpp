// A group of rays against the triangles of a block, one triangle at a time.
#if defined(RAYWISE_TRACE_SIMD_WIDE_GROUP_BLOCK) ==                                                \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_GROUP_BLOCK
#undef RAYWISE_TRACE_SIMD_WIDE_GROUP_BLOCK
#else
#define RAYWISE_TRACE_SIMD_WIDE_GROUP_BLOCK
#endif

#include "trace/simd/wide_block.inl.hpp"
#include "trace/simd/wide_group.inl.hpp"

#include <raywise/bvh/wide_bvh.hpp>

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

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

/// How far boxes matter to each ray of a group, below 0 for those that are done; and the greatest.
class GroupReach {
public:
    HWY_INLINE explicit GroupReach(RayLanes t_max) {
        lanes_.store(reach_lanes(t_max));
        measure();
    }

    [[nodiscard]] HWY_INLINE RayLanes lanes() const { return lanes_.load(); }

    [[nodiscard]] HWY_INLINE float farthest() const { return farthest_; }

    /// To what lies before `t`.
    HWY_INLINE void shorten(RayMask rays, RayLanes t) { set(rays, reach_lanes(t)); }

    HWY_INLINE void end(RayMask rays) { set(rays, hn::Set(Many(), -1.0F)); }

private:
    HWY_INLINE void set(RayMask rays, RayLanes reach) {
        lanes_.store(hn::IfThenElse(rays, reach, lanes_.load()));
        measure();
    }

    HWY_INLINE void measure() { farthest_ = hn::GetLane(hn::MaxOfLanes(Many(), lanes_.load())); }

    PerRay lanes_;
    float farthest_ = 0;
};

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
