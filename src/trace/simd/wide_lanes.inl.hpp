// The vectors of the kernels and what Highway has no word for.
#if defined(RAYWISE_TRACE_SIMD_WIDE_LANES) == defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_LANES
#undef RAYWISE_TRACE_SIMD_WIDE_LANES
#else
#define RAYWISE_TRACE_SIMD_WIDE_LANES
#endif

#include <raywise/bvh/wide_bvh.hpp>

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

#if HWY_TARGET != HWY_SCALAR // which has no vectors

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Eight = hn::CappedTag<float, WideNode::width>;
using Four = hn::FixedTag<float, TriangleBlock::width>;

constexpr float unit_roundoff = 0x1p-24F;

/// Bit i: lane i of the mask.
template <class D, class Mask>
HWY_INLINE std::uint32_t bits_of(D d, Mask mask) {
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(d, mask, bits.data());
    if constexpr (hn::MaxLanes(D()) <= 8)
        return bits[0];
    else
        return bits[0] | std::uint32_t{bits[1]} << 8U;
}

HWY_INLINE const float* floats_at(const void* base, std::size_t bytes) {
    return reinterpret_cast<const float*>(static_cast<const std::byte*>(base) + bytes);
}

} // namespace HWY_NAMESPACE
} // namespace raywise::simd

HWY_AFTER_NAMESPACE();

#endif

#endif
