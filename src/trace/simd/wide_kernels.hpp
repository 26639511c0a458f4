// The table of query kernels that every instruction set fills.
#pragma once

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/observer.hpp>

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace raywise::simd {

/// Queries of one mode; a miss of `closest_batch` is Hit{}. The trees are not empty; rays that are
/// not valid hit nothing.
struct WideKernels {
    std::optional<Hit> (*closest)(const WideBvh&, const Ray&);
    bool (*any)(const WideBvh&, const Ray&);
    void (*all)(const WideBvh&, const Ray&, FunctionRef<void(const Hit&)>);
    std::optional<Hit> (*closest_counted)(const WideBvh&, const Ray&, Counts&);
    bool (*any_counted)(const WideBvh&, const Ray&, Counts&);
    void (*closest_batch)(const WideBvh&, const Ray*, Hit*, std::size_t);
    void (*any_batch)(const WideBvh&, const Ray*, bool*, std::size_t);
};

struct WideKernelTable {
    WideKernels watertight;
    WideKernels fast;
};

/// The instruction sets that this machine has, best first.
[[nodiscard]] std::vector<std::string_view> wide_target_names();

/// The table of one of them, or the best when empty. Throws Error for another name.
[[nodiscard]] const WideKernelTable& wide_kernels_named(std::string_view name);

} // namespace raywise::simd
