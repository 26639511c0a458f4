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
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trace/simd/wide_kernels.cpp"
#include <hwy/foreach_target.h>
// After the above, which includes this file again.
#include "trace/simd/wide_block.inl.hpp"
#include "trace/simd/wide_group_query.inl.hpp"
#include "trace/simd/wide_prepare.inl.hpp"
#include "trace/simd/wide_settle.inl.hpp"
#include "trace/simd/wide_traverse.inl.hpp"

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

const WideKernelTable* kernel_table() {
    return &scalar_kernels();
}

#else

namespace hn = hwy::HWY_NAMESPACE;

/// The hit of one lane in the fast mode.
HWY_INLINE Hit
fast_hit(const Ray& ray, const TriangleBlock& block, const Candidates& found, std::size_t lane) {
    const Triangle triangle = block.triangle(lane);
    const bool front =
        dot(cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0), ray.direction) < 0;
    return {found.low[lane] + 0.0F, found.u[lane], found.v[lane], block.prims[lane], front};
}

/// Triangles that the filter leaves open. Few rays meet one; a call where they do would make every
/// ray save the registers of the traversal before each leaf.
class Doubts {
public:
    // Not defaulted: that would make values of it zeros first.
    HWY_INLINE Doubts() {} // NOLINT(modernize-use-equals-default)

    HWY_INLINE Doubts(const TriangleBlock& block, std::uint32_t bits) { add(block, bits); }

    /// Notes the lanes of `bits`; false when there are too many.
    HWY_INLINE bool add(const TriangleBlock& block, std::uint32_t bits) {
        for (; bits != 0; bits &= bits - 1) {
            if (count_ == capacity) [[unlikely]]
                return false;
            lanes_[count_++] = {&block, static_cast<std::size_t>(std::countr_zero(bits))};
        }
        return true;
    }

    [[nodiscard]] HWY_INLINE bool is_empty() const { return count_ == 0; }

    [[nodiscard]] HWY_NOINLINE bool any_hit(const Ray& ray) const {
        for (std::size_t i = 0; i < count_; ++i)
            if (lanes_[i].decide(ray, ray.t_max)) return true;
        return false;
    }

    /// The nearest of `hit` and theirs.
    [[nodiscard]] HWY_NOINLINE std::optional<Hit>
    nearest(const Ray& ray, std::optional<Hit> hit) const {
        for (std::size_t i = 0; i < count_; ++i)
            if (const auto other = lanes_[i].decide(ray, hit ? hit->t : ray.t_max))
                if (!hit || is_closer(*other, *hit)) hit = other;
        return hit;
    }

private:
    static constexpr std::size_t capacity = 12; // the triangles around two vertices

    struct Lane {
        const TriangleBlock* block;
        std::size_t lane;

        [[nodiscard]] std::optional<Hit> decide(const Ray& ray, float t_max) const {
            return ExactKernel::decide(ray, block->triangle(lane), block->prims[lane], t_max);
        }
    };

    std::array<Lane, capacity> lanes_; // NOLINT(*-member-init): written before read
    std::size_t count_ = 0;
};

/// The query of a ray that `prepare` refuses.
template <auto query>
HWY_NOINLINE auto refused(const WideBvh& tree, const Ray& ray, Silent&) {
    Counts counts;
    return query(tree, ray, counts);
}

template <auto query>
auto refused(const WideBvh& tree, const Ray& ray, Counts& counts) {
    return query(tree, ray, counts);
}

/// The nearest hit among the sure ones. In watertight mode its t is known within an interval until
/// the end, for most are overtaken by a nearer one before it matters which t exactly.
template <TraceMode mode>
struct Nearest {
    const TriangleBlock* block = nullptr;
    std::size_t lane = 0;
    float low = std::numeric_limits<float>::infinity(); ///< its t is not below
    float most_t = 0;                                   ///< nor above
    float limit = 0;                                    ///< no hit with a greater t is wanted
    float u = 0, v = 0;                                 ///< of the fast mode

    /// Takes the lane when it is surely nearer than all before; false when that is not known.
    HWY_INLINE bool take(const TriangleBlock& from, const Candidates& found, std::size_t index) {
        if constexpr (mode == TraceMode::fast) {
            const float t = found.low[index] + 0.0F;
            if (t > limit ||
                (t == limit && block != nullptr && from.prims[index] > block->prims[lane]))
                return true;
            limit = t;
            u = found.u[index];
            v = found.v[index];
        } else {
            if (found.low[index] > limit) return true;
            if ((found.sure >> index & 1U) == 0) return false;
            if (found.high[index] >= low) {
                // Often the same triangle, of another leaf.
                if (from.prims[index] == block->prims[lane]) return true;
                limit = found.high[index] < limit ? found.high[index] : limit;
                return false;
            }
            low = found.low[index];
            limit = most_t = found.high[index];
        }
        block = &from;
        lane = index;
        return true;
    }

    /// Fills `hit` when there is one.
    HWY_INLINE void
    settle_into(std::optional<Hit>& hit, const Ray& ray, const WideRay& wide) const {
        if (block == nullptr) return;
        if constexpr (mode == TraceMode::fast) {
            const auto [v0, v1, v2] = block->triangle(lane);
            const bool front = dot(cross(v1 - v0, v2 - v0), ray.direction) < 0;
            hit.emplace(Hit{limit, u, v, block->prims[lane], front});
        } else if (!settle(ray, *block, lane, most_t, wide.largest, hit)) [[unlikely]] {
            hit = ExactKernel::decide(ray, block->triangle(lane), block->prims[lane], ray.t_max);
        }
    }
};

/// What the traversal of a closest hit query does with blocks. Classes, for lambdas are not inlined
/// for sure, and all of this is the inner loop.
template <TraceMode mode>
struct FindNearest {
    HWY_INLINE explicit FindNearest(const WideRay& ray) : wide(ray) { nearest.limit = ray.t_max; }

    const WideRay& wide;
    Nearest<mode> nearest;
    Doubts doubts;
    bool is_overfull = false;

    HWY_INLINE bool operator()(const TriangleBlock& block, float& reach_limit) {
        const Candidates found = meet_block<mode>(wide, block, nearest.limit);
        if (found.possible == 0) return true;
        std::uint32_t open = 0;
        for (std::uint32_t left = found.possible; left != 0; left &= left - 1)
            if (!nearest.take(block, found, static_cast<std::size_t>(std::countr_zero(left))))
                open |= left & (0U - left);
        reach_limit = reach(nearest.limit);
        if (open != 0) [[unlikely]]
            is_overfull = !doubts.add(block, open);
        return !is_overfull;
    }
};

/// The same for any hit.
template <TraceMode mode>
struct FindAny {
    HWY_INLINE explicit FindAny(const WideRay& ray) : wide(ray) {}

    const WideRay& wide;
    Doubts doubts;
    bool is_hit = false;
    bool is_overfull = false;

    HWY_INLINE bool operator()(const TriangleBlock& block, float&) {
        const Candidates found = meet_block<mode>(wide, block, wide.t_max);
        is_hit = found.sure != 0;
        if (found.possible == 0 || is_hit) return !is_hit;
        is_overfull = !doubts.add(block, found.possible);
        return !is_overfull;
    }
};

/// For rays with more doubts than those hold: decides each at once.
template <class Observer>
HWY_NOINLINE std::optional<Hit>
closest_decided(const WideBvh& tree, const Ray& ray, const WideRay& wide, Observer& seen) {
    std::optional<Hit> best;
    traverse<true>(tree, wide, seen, [&](const TriangleBlock& block, float& reach_limit) HWY_ATTR {
        const float limit = best ? best->t : ray.t_max;
        const Candidates found = meet_block<TraceMode::watertight>(wide, block, limit);
        const auto hit = Doubts(block, found.possible).nearest(ray, best);
        if (hit) reach_limit = reach(hit->t);
        best = hit;
        return true;
    });
    return best;
}

template <class Observer>
HWY_NOINLINE bool
any_decided(const WideBvh& tree, const Ray& ray, const WideRay& wide, Observer& seen) {
    bool is_hit = false;
    traverse<false>(tree, wide, seen, [&](const TriangleBlock& block, float&) HWY_ATTR {
        const Candidates found = meet_block<TraceMode::watertight>(wide, block, ray.t_max);
        is_hit = found.sure != 0 || Doubts(block, found.possible).any_hit(ray);
        return !is_hit;
    });
    return is_hit;
}

/// Fills `hit` when there is one: in place, for a copy of what was just written stalls.
template <TraceMode mode, class Observer>
HWY_INLINE void
find_closest(const WideBvh& tree, const Ray& ray, Observer& seen, std::optional<Hit>& hit) {
    WideRay wide; // NOLINT(*-member-init): prepare fills it
    if (!prepare(ray, tree, wide)) [[unlikely]] {
        hit = refused<&closest_scalar>(tree, ray, seen);
        return;
    }
    FindNearest<mode> find(wide);
    traverse<true>(tree, wide, seen, find);
    if (find.is_overfull) [[unlikely]] {
        hit = closest_decided(tree, ray, wide, seen);
        return;
    }
    find.nearest.settle_into(hit, ray, wide);
    if (!find.doubts.is_empty()) [[unlikely]]
        hit = find.doubts.nearest(ray, hit);
}

template <TraceMode mode, class Observer>
std::optional<Hit> closest(const WideBvh& tree, const Ray& ray, Observer& seen) {
    std::optional<Hit> hit;
    find_closest<mode>(tree, ray, seen, hit);
    return hit;
}

template <TraceMode mode, class Observer>
bool any(const WideBvh& tree, const Ray& ray, Observer& seen) {
    WideRay wide; // NOLINT(*-member-init): prepare fills it
    if (!prepare(ray, tree, wide)) [[unlikely]]
        return refused<&any_scalar>(tree, ray, seen);
    FindAny<mode> find(wide);
    traverse<false>(tree, wide, seen, find);
    if (find.is_overfull) [[unlikely]]
        return any_decided(tree, ray, wide, seen);
    return find.is_hit || (!find.doubts.is_empty() && find.doubts.any_hit(ray));
}

template <TraceMode mode>
void all(const WideBvh& tree, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    WideRay wide; // NOLINT(*-member-init): prepare fills it
    if (!prepare(ray, tree, wide)) [[unlikely]] {
        all_scalar(tree, ray, visit);
        return;
    }
    Silent seen;
    traverse<false>(tree, wide, seen, [&](const TriangleBlock& block, float&) HWY_ATTR {
        const Candidates found = meet_block<mode>(wide, block, ray.t_max);
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
std::optional<Hit> closest_silent(const WideBvh& tree, const Ray& ray) {
    Silent seen;
    return closest<mode>(tree, ray, seen);
}

template <TraceMode mode>
bool any_silent(const WideBvh& tree, const Ray& ray) {
    Silent seen;
    return any<mode>(tree, ray, seen);
}

template <TraceMode mode>
std::optional<Hit> closest_counted(const WideBvh& tree, const Ray& ray, Counts& counts) {
    return closest<mode>(tree, ray, counts);
}

template <TraceMode mode>
bool any_counted(const WideBvh& tree, const Ray& ray, Counts& counts) {
    return any<mode>(tree, ray, counts);
}

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3

template <TraceMode mode>
void closest_batch(const WideBvh& tree, const Ray* rays, Hit* hits, std::size_t count) {
    by_groups(
        count,
        [&](std::size_t i) { return closest_of_group<mode>(tree, rays + i, hits + i); },
        [&](std::size_t i) { hits[i] = closest_silent<mode>(tree, rays[i]).value_or(Hit{}); }
    );
}

template <TraceMode mode>
void any_batch(const WideBvh& tree, const Ray* rays, bool* occluded, std::size_t count) {
    by_groups(
        count,
        [&](std::size_t i) { return any_of_group<mode>(tree, rays + i, occluded + i); },
        [&](std::size_t i) { occluded[i] = any_silent<mode>(tree, rays[i]); }
    );
}

#else

template <TraceMode mode>
void closest_batch(const WideBvh& tree, const Ray* rays, Hit* hits, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        hits[i] = closest_silent<mode>(tree, rays[i]).value_or(Hit{});
}

template <TraceMode mode>
void any_batch(const WideBvh& tree, const Ray* rays, bool* occluded, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        occluded[i] = any_silent<mode>(tree, rays[i]);
}

#endif

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

#endif

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
