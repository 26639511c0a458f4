// The two-level structure: a local tree per influence area, a global tree over everything, and
// queries that are exact whatever the areas. After [Falcone24]; ours: the proof, the continuation
// on the remaining interval, any hit.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/area_id.hpp>
#include <raywise/toplevel/build_tree.hpp>
#include <raywise/toplevel/membership.hpp>
#include <raywise/toplevel/region_index.hpp>
#include <raywise/toplevel/served.hpp>
#include <raywise/trace/triangles.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace raywise {

/// How a query goes on when an area has been searched.
enum class QueryMode : std::uint8_t {
    exact, ///< on the interval that is still unknown: the answer of one tree over everything
    /// The thesis's rule: the first local hit wins, a local miss starts the global tree afresh.
    /// Areas are tried by index, eight at most. Answers can be wrong; for analysis only.
    /// [Falcone24]
    first_hit_wins,
};

/// When an area is not worth asking. The expected cost of its sampled rays is counted once through
/// the area and once through the global tree alone; an area that saves nothing is disabled.
struct GainParams {
    std::size_t rays = 1024; ///< per area, in [1, 10^7]
    std::uint64_t seed = 1;
};

struct AcceleratorParams {
    Heuristic local{};                           ///< of the areas' trees
    Heuristic global = surface_area_heuristic(); ///< of the tree over everything
    MembershipParams membership{};               ///< `vertices` only with QueryMode::first_hit_wins
    RegionIndexParams index{}; ///< OctreeMode::over only with QueryMode::first_hit_wins
    int max_candidates = 1;    ///< areas that a ray tries before the global tree, in [1, 8]
    QueryMode mode = QueryMode::exact;
    std::optional<GainParams> gain{}; ///< absent: every area is used
};

/// Bytes of the containers, by what they hold.
struct AcceleratorMemory {
    std::size_t global_tree = 0;
    std::size_t global_triangles = 0;
    std::size_t local_trees = 0;
    std::size_t local_triangles = 0;
    std::size_t areas = 0; ///< the areas themselves; a measured area's rays are shared, not counted
    std::size_t index = 0;

    [[nodiscard]] std::size_t total() const {
        return global_tree + global_triangles + local_trees + local_triangles + areas + index;
    }
};

/// What one influence area owns.
struct LocalStructure {
    Bvh tree;                   ///< its primitives are ids of the whole scene
    PackedTriangles triangles;  ///< a copy, in the order of the tree's slots
    double expected_cost = 0;   ///< of a ray that hits the root, by the area's measure, unpruned
    bool is_enabled = true;     ///< false: rays of this area go to the global tree directly
    std::optional<double> gain; ///< cost saved per sampled ray, when GainParams asked for it
};

class AreaHandle;

/// Answers ray queries over all triangles; rays that belong to an influence area are answered by
/// its local tree as far as that proves the answer. (t, id) are those of one tree over everything,
/// for every ray. Owns copies of the triangles (36 bytes per triangle and tree), so the caller's
/// mesh may go. Const queries are thread-safe and allocate nothing; a ray that is not `is_valid`
/// misses.
class Accelerator {
public:
    /// The hit with the smallest (t, id) in [t_min, t_max].
    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray) const;

    /// Whether there is a hit in [t_min, t_max].
    [[nodiscard]] bool any_hit(const Ray& ray) const;

    /// Calls `visit(const Hit&)` for every hit in [t_min, t_max], once each, in no particular
    /// order.
    template <class Visitor>
    void all_hits(const Ray& ray, Visitor&& visit) const;

    /// The same queries, watched: a QueryObserver such as Served, or a Counts in a CountedQuery.
    template <QueryObserver Observer>
    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray, Observer& seen) const;
    template <QueryObserver Observer>
    [[nodiscard]] bool any_hit(const Ray& ray, Observer& seen) const;

    /// hits[i] is the closest hit of rays[i]; a default Hit (t = +inf, no_prim) where there is
    /// none. Throws Error when the sizes differ. Parallel; the same for any executor.
    void closest_hits(
        std::span<const Ray> rays,
        std::span<Hit> hits,
        const Executor& executor = serial_executor()
    ) const;

    /// occluded[i] tells whether rays[i] has a hit.
    void any_hits(
        std::span<const Ray> rays,
        std::span<bool> occluded,
        const Executor& executor = serial_executor()
    ) const;

    /// This accelerator with local trees by another heuristic; the global tree and the index are
    /// copied, not built again. `triangles` must be those that this one was built from.
    [[nodiscard]] Accelerator with_local_heuristic(
        const Heuristic& local,
        const TriangleView& triangles,
        const Executor& executor = serial_executor(),
        const Progress& progress = {}
    ) const;

    /// The area of that name, for callers who know which area their rays belong to. Throws Error
    /// when there is none. Valid as long as the accelerator stays where it is.
    [[nodiscard]] AreaHandle operator[](std::string_view name) const;
    [[nodiscard]] AreaHandle operator[](AreaId id) const;

    [[nodiscard]] std::span<const InfluenceArea> areas() const { return areas_; }

    [[nodiscard]] const LocalStructure& local(AreaId id) const {
        return locals_[static_cast<std::size_t>(id)];
    }

    [[nodiscard]] const Bvh& global_tree() const { return global_tree_; }

    [[nodiscard]] const PackedTriangles& global_triangles() const { return global_triangles_; }

    [[nodiscard]] const AnyRegionIndex& index() const { return index_; }

    [[nodiscard]] const AcceleratorParams& params() const { return params_; }

    /// O(areas).
    [[nodiscard]] AcceleratorMemory measure_memory() const;

private:
    friend class AreaHandle;
    friend Accelerator
    build_accelerator(const TriangleView&, std::vector<InfluenceArea>, const AcceleratorParams&, const Executor&, const Progress&);

    /// An area that a ray may be answered by, and the end of the interval that it proves.
    struct Candidate {
        AreaId area{};
        float exit = 0;
    };

    static constexpr std::size_t most_candidates = 8;

    /// A few candidates, best first; on the stack.
    struct Candidates {
        Candidate items[most_candidates];
        std::size_t count = 0;
    };

    /// The local trees of all areas, and whether they pay.
    void
    build_locals(const TriangleView& triangles, const Executor& executor, const Progress& progress);

    /// The areas to ask for a valid ray, best first.
    [[nodiscard]] Candidates candidates_of(const Ray& ray) const;

    /// That area, if the ray starts in it, whether or not it is affine.
    [[nodiscard]] Candidates candidates_in(AreaId area, const Ray& ray) const;

    /// End of the interval of the ray that the area's tree can prove; at most 0 if it proves none.
    [[nodiscard]] float proven_end(AreaId area, const Ray& ray) const;

    [[nodiscard]] bool is_cheaper(const Candidate& a, const Candidate& b) const;
    [[nodiscard]] bool is_better(const Candidate& a, const Candidate& b, float t_max) const;

    template <class Observer>
    std::optional<Hit>
    closest_among(const Ray& ray, const Candidates& candidates, Observer& seen) const;
    template <class Observer>
    bool any_among(const Ray& ray, const Candidates& candidates, Observer& seen) const;
    template <class Observer>
    std::optional<Hit>
    first_hit_wins(const Ray& ray, const Candidates& candidates, Observer& seen) const;
    template <class Observer>
    std::optional<Hit>
    closest_by_mode(const Ray& ray, const Candidates& candidates, Observer& seen) const;
    template <class Observer>
    bool any_by_mode(const Ray& ray, const Candidates& candidates, Observer& seen) const;

    AcceleratorParams params_;
    std::vector<InfluenceArea> areas_;
    std::vector<LocalStructure> locals_;
    AnyRegionIndex index_;
    Bvh global_tree_;
    PackedTriangles global_triangles_;
};

/// One area of an accelerator: its queries skip the search for the area and the test of affinity.
/// The answers are exact for any ray, also one that has nothing to do with the area.
class AreaHandle {
public:
    AreaHandle(const Accelerator& owner, AreaId id) : owner_(&owner), id_(id) {}

    [[nodiscard]] AreaId id() const { return id_; }

    [[nodiscard]] const InfluenceArea& area() const;

    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray) const;
    [[nodiscard]] bool any_hit(const Ray& ray) const;
    template <QueryObserver Observer>
    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray, Observer& seen) const;
    template <QueryObserver Observer>
    [[nodiscard]] bool any_hit(const Ray& ray, Observer& seen) const;

    /// See Accelerator::closest_hits.
    void closest_hits(
        std::span<const Ray> rays,
        std::span<Hit> hits,
        const Executor& executor = serial_executor()
    ) const;

    /// See Accelerator::any_hits.
    void any_hits(
        std::span<const Ray> rays,
        std::span<bool> occluded,
        const Executor& executor = serial_executor()
    ) const;

    /// shadowed[i] tells whether something stands between points[i] and the emitter: a ray
    /// against the direction of a parallel area, or to the eye of a radial one. It starts `offset`
    /// (scene units, >= 0) away from the point, so that the surface under the point does not count;
    /// a radial ray shorter than that is not shadowed. Throws Error for areas of uniform or
    /// measured rays, which have no emitter, and when the sizes differ.
    void occluded(
        std::span<const Vec3> points,
        std::span<bool> shadowed,
        float offset = 0,
        const Executor& executor = serial_executor()
    ) const;

private:
    const Accelerator* owner_;
    AreaId id_;
};

/// Builds the global tree, the region index, and a local tree per area over the triangles of its
/// region. Names must differ. Coordinates must be finite and within `max_coordinate`. Throws Error
/// otherwise, and for parameters out of range; Cancelled when the progress asks to stop. No
/// triangles: every query misses. The same for any executor.
[[nodiscard]] Accelerator build_accelerator(
    const TriangleView& triangles,
    std::vector<InfluenceArea> areas,
    const AcceleratorParams& params = {},
    const Executor& executor = serial_executor(),
    const Progress& progress = {}
);

[[nodiscard]] Accelerator build_accelerator(
    const Scene& scene,
    std::vector<InfluenceArea> areas,
    const AcceleratorParams& params = {},
    const Executor& executor = serial_executor(),
    const Progress& progress = {}
);

} // namespace raywise

#include <raywise/toplevel/accelerator.inl.hpp> // IWYU pragma: export
