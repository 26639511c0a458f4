// The pencil grid: what rays of one pencil meet, looked up by where they cross the pencil. After
// [Haines86], [Hunt08]. Ours: the integer cells and byte-sized lists, the culling behind two
// triangles, and the margins that keep every answer exact.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/pencil/pencil.hpp>
#include <raywise/pencil/pencil_grid_params.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace raywise {

/// What a grid says of a ray. Unknown is rare: the answer lies behind what the grid keeps, and
/// another structure must be asked.
enum class Verdict : std::uint8_t { miss, hit, unknown };

/// All triangles of a mesh, sorted for the rays of one pencil. A parallel pencil has one grid
/// across its direction; a radial one has a grid for each of the six world-axis cube faces around
/// the apex that sees a triangle. A cell lists its triangles by depth; what two triangles of the
/// cell hide from the emitter is not kept.
///
/// Its rays are those that `pencil().holds`: from a lit point to the emitter, or from the emitter's
/// side away. Answers are those of ExactKernel: never wrong, for any finite coordinates, and the
/// same for every instruction set; a ray that is not `is_valid` misses. `unknown` is said only
/// - for rays of another pencil;
/// - for rays that begin behind two triangles of their cell, or whose closest hit may lie there,
///   unless a shadow ray asks for any hit and reaches the emitter;
/// - for points very far outside the scene (beyond 4 times its distance from the apex, or 256 times
///   its coordinates).
/// Reads the caller's triangles where a ray passes so close to an edge that a cell leaves a doubt,
/// and for the place of a closest hit: they must stay as long as the grid is used. Const member
/// functions are thread-safe and do not allocate.
class PencilGrid {
public:
    struct Data; ///< internal

    explicit PencilGrid(std::unique_ptr<Data> data);
    ~PencilGrid();
    PencilGrid(const PencilGrid&) = delete;
    PencilGrid& operator=(const PencilGrid&) = delete;
    PencilGrid(PencilGrid&&) noexcept;
    PencilGrid& operator=(PencilGrid&&) noexcept;

    [[nodiscard]] const Pencil& pencil() const;

    /// Whether something is hit in [t_min, t_max].
    [[nodiscard]] Verdict any_hit(const Ray& ray) const;
    [[nodiscard]] Verdict any_hit(const Ray& ray, PencilGridCounts& counts) const;

    /// any_hit(pencil().shadow_ray(point, t_min, excluded)), for a t_min >= 0; a miss where that is
    /// not valid. The fastest way to ask.
    [[nodiscard]] Verdict
    occluded(const Vec3& point, float t_min = 0, PrimId excluded = no_prim) const;

    /// The closest hit in [t_min, t_max]. `hit` is Hit{} for a miss, and anything when it is
    /// unknown.
    [[nodiscard]] Verdict closest_hit(const Ray& ray, Hit& hit) const;
    [[nodiscard]] Verdict closest_hit(const Ray& ray, Hit& hit, PencilGridCounts& counts) const;

    /// Calls `visit` once for every hit in [t_min, t_max], in no particular order. Unknown when
    /// there may be others, else whether there was one.
    [[nodiscard]] Verdict all_hits(const Ray& ray, FunctionRef<void(const Hit&)> visit) const;

    /// any_hit for every ray; equal sizes. Rays whose answer is unknown are given to `otherwise`,
    /// which must be thread-safe. The answers do not depend on the threads. Fastest when all are
    /// shadow rays of the pencil.
    void any_hits(
        std::span<const Ray> rays,
        std::span<bool> hits,
        FunctionRef<bool(const Ray&)> otherwise,
        const Executor& executor = serial_executor()
    ) const;

    /// closest_hit for every ray; a miss is a default Hit, prim == no_prim. As any_hits;
    /// fastest when all come from an apex, with a t_min of 0.
    void closest_hits(
        std::span<const Ray> rays,
        std::span<Hit> hits,
        FunctionRef<Hit(const Ray&)> otherwise,
        const Executor& executor = serial_executor()
    ) const;

    /// occluded for every point. `excluded` is as long as `points`, or empty for none. As any_hits.
    void occluded(
        std::span<const Vec3> points,
        float t_min,
        std::span<const PrimId> excluded,
        std::span<bool> shadowed,
        FunctionRef<bool(const Ray&)> otherwise,
        const Executor& executor = serial_executor()
    ) const;

    [[nodiscard]] const PencilGridStatistics& statistics() const;

    /// Everything that queries read but the triangles.
    [[nodiscard]] std::size_t size_in_bytes() const;

    /// XXH3 of that: equal for any number of threads that built it.
    [[nodiscard]] std::uint64_t content_hash() const;

    /// The instruction set that queries run on: the best of the machine, as Highway names it.
    [[nodiscard]] std::string_view instruction_set() const;

    /// Switches to another one of `instruction_sets()`, for tests and timings. Throws Error when
    /// the machine does not have it. Not thread-safe.
    void use_instruction_set(std::string_view name);

    /// Those of this machine, best first.
    [[nodiscard]] static std::span<const std::string_view> instruction_sets();

private:
    std::unique_ptr<Data> data_;
};

/// Triangles with a vertex that is not finite are left out, as no ray hits them. The result is the
/// same for any number of threads. O(triangles + references); peak memory about 160 bytes a
/// triangle beside the result. Throws Error for parameters out of range or more than 2^31
/// triangles.
[[nodiscard]] PencilGrid build_pencil_grid(
    const TriangleView& triangles,
    const Pencil& pencil,
    const PencilGridParams& params = {},
    const Executor& executor = serial_executor()
);

} // namespace raywise
