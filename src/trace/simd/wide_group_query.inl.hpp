// Batches by groups of rays.
#if defined(RAYWISE_TRACE_SIMD_WIDE_GROUP_QUERY) ==                                                \
    defined(HWY_TARGET_TOGGLE) // once per instruction set
#ifdef RAYWISE_TRACE_SIMD_WIDE_GROUP_QUERY
#undef RAYWISE_TRACE_SIMD_WIDE_GROUP_QUERY
#else
#define RAYWISE_TRACE_SIMD_WIDE_GROUP_QUERY
#endif

#include "trace/simd/wide_group.inl.hpp"
#include "trace/simd/wide_group_any.inl.hpp"
#include "trace/simd/wide_group_nearest.inl.hpp"
#include "trace/simd/wide_group_traverse.inl.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/wide.hpp>

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

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
