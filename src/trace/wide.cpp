#include <raywise/trace/wide.hpp>

#include "trace/simd/wide_kernels.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/observer.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace raywise {
namespace {

using simd::WideKernels;
using simd::WideKernelTable;

constexpr std::size_t chunk = 1024;

/// Chosen by the first query, or forced by a test: the one state that outlives a call, and no
/// answer depends on it.
std::atomic<const WideKernelTable*>& chosen_table() {
    static std::atomic<const WideKernelTable*> table{&simd::wide_kernels_named("")};
    return table;
}

const WideKernels& kernels(TraceMode mode) {
    const WideKernelTable& table = *chosen_table().load(std::memory_order_relaxed);
    return mode == TraceMode::watertight ? table.watertight : table.fast;
}

} // namespace

std::optional<Hit> closest_hit(const WideBvh& tree, const Ray& ray, TraceMode mode) {
    if (tree.is_empty()) return std::nullopt;
    return kernels(mode).closest(tree, ray);
}

bool any_hit(const WideBvh& tree, const Ray& ray, TraceMode mode) {
    return !tree.is_empty() && kernels(mode).any(tree, ray);
}

void all_hits(
    const WideBvh& tree,
    const Ray& ray,
    FunctionRef<void(const Hit&)> visit,
    TraceMode mode
) {
    if (!tree.is_empty()) kernels(mode).all(tree, ray, visit);
}

std::optional<Hit>
closest_hit(const WideBvh& tree, const Ray& ray, Counts& counts, TraceMode mode) {
    if (tree.is_empty()) return std::nullopt;
    return kernels(mode).closest_counted(tree, ray, counts);
}

bool any_hit(const WideBvh& tree, const Ray& ray, Counts& counts, TraceMode mode) {
    return !tree.is_empty() && kernels(mode).any_counted(tree, ray, counts);
}

void closest_hits(
    const WideBvh& tree,
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor,
    TraceMode mode
) {
    if (rays.size() != hits.size()) throw Error("wide: as many hits as rays are needed");
    const auto batch = kernels(mode).closest_batch;
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        if (tree.is_empty())
            std::fill_n(hits.data() + begin, end - begin, Hit{});
        else
            batch(tree, rays.data() + begin, hits.data() + begin, end - begin);
    });
}

void any_hits(
    const WideBvh& tree,
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor,
    TraceMode mode
) {
    if (rays.size() != occluded.size()) throw Error("wide: as many answers as rays are needed");
    const auto batch = kernels(mode).any_batch;
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        if (tree.is_empty())
            std::fill_n(occluded.data() + begin, end - begin, false);
        else
            batch(tree, rays.data() + begin, occluded.data() + begin, end - begin);
    });
}

std::vector<std::string_view> simd_targets() {
    return simd::wide_target_names();
}

void force_simd_target(std::string_view name) {
    chosen_table().store(&simd::wide_kernels_named(name));
}

} // namespace raywise
