// Queries on wide trees, by vector instructions chosen when the program runs. After [Wald08],
// [Woop13]. Ours: the slab that rounds outward for free, and the filter that leaves to exact
// arithmetic only what is close.
#pragma once

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/observer.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace raywise {

/// Which arithmetic decides what a ray hits.
enum class TraceMode : std::uint8_t {
    watertight, ///< as ExactKernel: the answers of brute force, to the bit
    /// Floats alone. A ray that passes within some roundings of an edge may miss the triangles on
    /// both sides or hit one that it passes by; t, u and v are off by some roundings of the
    /// triangle's coordinates as seen from the origin, so that of triangles closer together than
    /// that either may be the closest. Still no hit outside [t_min, t_max], and rays that are not
    /// `is_valid` miss. Answers may differ between machines; single queries and batches may too.
    fast,
};

/// The hit with the smallest (t, triangle id) among those with t in [t_min, t_max]. Nothing for an
/// empty tree or a ray that is not `is_valid`. No allocation; safe from any number of threads. The
/// same on every machine when watertight.
[[nodiscard]] std::optional<Hit>
closest_hit(const WideBvh& tree, const Ray& ray, TraceMode mode = TraceMode::watertight);

/// Whether some triangle is hit at t in [t_min, t_max]. Contract as closest_hit.
[[nodiscard]] bool
any_hit(const WideBvh& tree, const Ray& ray, TraceMode mode = TraceMode::watertight);

/// Calls `visit` for every hit with t in [t_min, t_max], in no particular order; a triangle that
/// stands in several leaves may be visited once for each. Contract as closest_hit.
void all_hits(
    const WideBvh& tree,
    const Ray& ray,
    FunctionRef<void(const Hit&)> visit,
    TraceMode mode = TraceMode::watertight
);

/// closest_hit of every ray, in parallel; a miss is `Hit{}`. Throws Error when the sizes differ.
/// Fastest where rays side by side run the same way from and to places close together, as those of
/// a camera do in tiles.
void closest_hits(
    const WideBvh& tree,
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor = serial_executor(),
    TraceMode mode = TraceMode::watertight
);

/// any_hit of every ray, in parallel. Throws Error when the sizes differ. See closest_hits.
void any_hits(
    const WideBvh& tree,
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor = serial_executor(),
    TraceMode mode = TraceMode::watertight
);

/// closest_hit and any_hit that add to `counts` what they did: nodes and leaves opened, eight box
/// tests per node, four triangle tests per block. The counts may differ between instruction sets.
[[nodiscard]] std::optional<Hit> closest_hit(
    const WideBvh& tree,
    const Ray& ray,
    Counts& counts,
    TraceMode mode = TraceMode::watertight
);
[[nodiscard]] bool any_hit(
    const WideBvh& tree,
    const Ray& ray,
    Counts& counts,
    TraceMode mode = TraceMode::watertight
);

/// The instruction sets that the kernels can use on this machine, best first, such as "AVX2".
[[nodiscard]] std::vector<std::string_view> simd_targets();

/// Makes all queries of this process use one of simd_targets(), or the best again when empty: for
/// tests that compare them. Not while queries run. Throws Error for another name.
void force_simd_target(std::string_view name);

} // namespace raywise
