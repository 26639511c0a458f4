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
#include "trace/simd/wide_traverse.inl.hpp"

HWY_BEFORE_NAMESPACE();

namespace raywise::simd {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The hit of one lane in the fast mode.
HWY_INLINE Hit
fast_hit(const Ray& ray, const TriangleBlock& block, const Candidates& found, std::size_t lane) {
    const Triangle triangle = block.triangle(lane);
    const bool front =
        dot(cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0), ray.direction) < 0;
    return {found.t[lane] + 0.0F, found.u[lane], found.v[lane], block.prims[lane], front};
}

/// The nearest hit so far. In watertight mode its t is known within an interval until `settle`, for
/// most are overtaken by a nearer one before it matters which t exactly.
template <TraceMode mode>
class Nearest {
public:
    HWY_INLINE explicit Nearest(const Ray& ray) : ray_(ray), limit_(ray.t_max) {}

    /// No hit with a greater t is wanted.
    [[nodiscard]] HWY_INLINE float limit() const { return limit_; }

    /// Takes what is nearer among the candidates of a block; whether something was.
    HWY_INLINE bool take(const TriangleBlock& block, const Candidates& found) {
        bool taken = false;
        for (std::uint32_t left = found.possible; left != 0; left &= left - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(left));
            if constexpr (mode == TraceMode::fast) {
                const float t = found.t[lane] + 0.0F;
                if (t > limit_ || (t == limit_ && block_ != nullptr && block.prims[lane] > prim_))
                    continue;
                limit_ = t;
                u_ = found.u[lane];
                v_ = found.v[lane];
            } else {
                const float low = found.t[lane] - found.t_error[lane];
                const float high = found.t[lane] + found.t_error[lane];
                if (low > limit_) continue;
                if ((found.sure >> lane & 1U) == 0 || high >= low_) {
                    taken = decide(block, lane) || taken;
                    continue;
                }
                low_ = low;
                limit_ = high;
                is_settled_ = false;
            }
            block_ = &block;
            lane_ = lane;
            prim_ = block.prims[lane];
            taken = true;
        }
        return taken;
    }

    [[nodiscard]] HWY_INLINE std::optional<Hit> hit() const {
        if (block_ == nullptr) return std::nullopt;
        if constexpr (mode == TraceMode::watertight) {
            if (is_settled_) return hit_;
            return ExactKernel::decide(ray_, block_->triangle(lane_), prim_, ray_.t_max);
        } else {
            const auto [v0, v1, v2] = block_->triangle(lane_);
            const bool front = dot(cross(v1 - v0, v2 - v0), ray_.direction) < 0;
            return Hit{limit_, u_, v_, prim_, front};
        }
    }

private:
    /// Makes t exact.
    HWY_NOINLINE void settle() {
        if (block_ == nullptr || is_settled_) return;
        is_settled_ = true;
        hit_ = *ExactKernel::decide(ray_, block_->triangle(lane_), prim_, ray_.t_max);
        low_ = limit_ = hit_.t;
    }

    /// For a triangle too close to an edge, to the end of the interval or to the nearest so far.
    HWY_NOINLINE bool decide(const TriangleBlock& block, std::size_t lane) {
        settle();
        const auto hit = ExactKernel::decide(ray_, block.triangle(lane), block.prims[lane], limit_);
        if (!hit || (block_ != nullptr && !is_closer(*hit, hit_))) return false;
        hit_ = *hit;
        low_ = limit_ = hit_.t;
        block_ = &block;
        lane_ = lane;
        prim_ = block.prims[lane];
        is_settled_ = true;
        return true;
    }

    const Ray& ray_;
    const TriangleBlock* block_ = nullptr;
    std::size_t lane_ = 0;
    PrimId prim_ = no_prim;
    float limit_;
    float low_ = std::numeric_limits<float>::infinity(); ///< t of the nearest is not below
    float u_ = 0, v_ = 0;
    bool is_settled_ = false;
    Hit hit_;
};

template <TraceMode mode, class Observer>
std::optional<Hit> closest(const WideBvh& tree, const Ray& ray, Observer& seen) {
    WideRay wide; // NOLINT(*-member-init): prepare fills it
    if (!prepare(ray, tree, wide)) [[unlikely]]
        return closest_scalar(tree, ray);
    Nearest<mode> nearest(ray);
    traverse<true>(tree, wide, seen, [&](const TriangleBlock& block, float& reach_limit) HWY_ATTR {
        const Candidates found = meet_block<mode>(wide, block, nearest.limit());
        if (found.possible != 0 && nearest.take(block, found)) reach_limit = reach(nearest.limit());
        return true;
    });
    return nearest.hit();
}

template <TraceMode mode, class Observer>
bool any(const WideBvh& tree, const Ray& ray, Observer& seen) {
    WideRay wide; // NOLINT(*-member-init): prepare fills it
    if (!prepare(ray, tree, wide)) [[unlikely]]
        return any_scalar(tree, ray);
    bool is_hit = false;
    traverse<false>(tree, wide, seen, [&](const TriangleBlock& block, float&) HWY_ATTR {
        const Candidates found = meet_block<mode>(wide, block, ray.t_max);
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
    WideRay wide; // NOLINT(*-member-init): prepare fills it
    if (!prepare(ray, tree, wide)) [[unlikely]]
        return all_scalar(tree, ray, visit);
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

template <TraceMode mode>
void closest_batch(const WideBvh& tree, const Ray* rays, Hit* hits, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        hits[i] = is_valid(rays[i]) ? closest_silent<mode>(tree, rays[i]).value_or(Hit{}) : Hit{};
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
