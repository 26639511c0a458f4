// The two-level structure: a structure of its own for each influence area that pays for one, a
// global tree over everything, and queries that are exact whatever the areas. After [Falcone24];
// ours: the proof, the continuation on the remaining interval, any hit, the pencil grids, the
// choice.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_copy.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil.hpp>
#include <raywise/pencil/pencil_grid.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/area_id.hpp>
#include <raywise/toplevel/build_tree.hpp>
#include <raywise/toplevel/build_wide.hpp>
#include <raywise/toplevel/membership.hpp>
#include <raywise/toplevel/region_index.hpp>
#include <raywise/toplevel/served.hpp>
#include <raywise/toplevel/structure_choice.hpp>
#include <raywise/toplevel/traced_tree.hpp>
#include <raywise/trace/wide.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
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
    /// Of every area that `uses` does not name. The structure is chosen by prediction, unless
    /// forced.
    AreaUse use{};
    std::map<std::string, AreaUse, std::less<>> uses{};        ///< by name of area
    StructureKind global_structure = StructureKind::wide_tree; ///< or binary_tree, to look at nodes
    TreeQuality quality = TreeQuality::high;                   ///< of wide trees
    Heuristic local{};                                         ///< of the areas' binary trees
    Heuristic global = surface_area_heuristic();               ///< of the tree over everything
    MembershipParams membership{}; ///< `vertices` only with QueryMode::first_hit_wins
    RegionIndexParams index{};     ///< OctreeMode::over only with QueryMode::first_hit_wins
    int max_candidates = 1;        ///< areas that a ray tries before the global tree, in [1, 8]
    QueryMode mode = QueryMode::exact;
    TraceMode trace_mode = TraceMode::watertight; ///< of wide trees; all else is always exact
    std::optional<GainParams> gain{};             ///< absent: every area is used
};

/// The accelerator of the thesis: binary trees everywhere, one for each area. What analysis wants:
/// its nodes can be watched.
[[nodiscard]] inline AcceleratorParams two_binary_levels() {
    AcceleratorParams params;
    params.use.structure = StructureKind::binary_tree;
    params.global_structure = StructureKind::binary_tree;
    return params;
}

/// Bytes of the containers, by what they hold; trees and grids with their triangles.
struct AcceleratorMemory {
    std::size_t global_tree = 0;
    std::size_t local_trees = 0;
    std::size_t grids = 0; ///< and copies for inversions
    std::size_t areas = 0; ///< the areas themselves; a measured area's rays are shared, not counted
    std::size_t index = 0;

    [[nodiscard]] std::size_t total() const {
        return global_tree + local_trees + grids + areas + index;
    }
};

/// What one influence area owns.
struct LocalStructure {
    StructureChoice choice; ///< what was built, and why
    TracedTree tree;        ///< of the tree kinds; its primitives are ids of the scene
    std::shared_ptr<const PencilGrid> grid;        ///< of the kind pencil_grid, else null
    std::shared_ptr<const TriangleCopy> triangles; ///< of grids and inversion, else null; shared
    std::optional<Pencil> pencil;                  ///< of exact areas, whatever was built
    double expected_cost = 0; ///< of a ray that hits a tree's root, by the area's measure
    bool is_whole = false;    ///< whether the tree is over all triangles, not only the region's
    bool has_tree = false;    ///< whether queries that start in the region ask the tree
    std::optional<double> gain = {}; ///< cost saved per sampled ray, when GainParams asked for it
};

class AreaHandle;

namespace detail {
class AcceleratorBuilder;
}

/// Answers ray queries over all triangles; rays that belong to an influence area are answered by
/// its own structure as far as that proves the answer. (t, id) are those of one tree over
/// everything, for every ray, unless AcceleratorParams::trace_mode is fast. A ray that nobody
/// assigned to an area is compared with the pencils of the areas that have a grid, then, where
/// areas have trees, searched by its origin. Owns copies of the triangles, so the caller's mesh may
/// go. Const queries are thread-safe, and single ones allocate nothing; a ray that is not
/// `is_valid` misses.
class Accelerator {
public:
    /// The hit with the smallest (t, id) in [t_min, t_max].
    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray) const;

    /// Whether there is a hit in [t_min, t_max].
    [[nodiscard]] bool any_hit(const Ray& ray) const;

    /// Calls `visit(const Hit&)` for every hit in [t_min, t_max], once each, by rising (t, id).
    /// Allocates the list.
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

    /// This accelerator with other local trees; the global tree and the index are copied, not built
    /// again. `triangles` must be those that this one was built from.
    [[nodiscard]] Accelerator with_local_heuristic(
        const Heuristic& local,
        const TriangleView& triangles,
        const Executor& executor = serial_executor(),
        const Progress& progress = {}
    ) const;

    /// A copy of this accelerator whose wide trees are traced in that mode.
    [[nodiscard]] Accelerator with_trace_mode(TraceMode mode) const;

    /// The area of that name, for callers who know which area their rays belong to. Throws Error
    /// when there is none. Valid as long as the accelerator stays where it is.
    [[nodiscard]] AreaHandle operator[](std::string_view name) const;
    [[nodiscard]] AreaHandle operator[](AreaId id) const;

    [[nodiscard]] std::span<const InfluenceArea> areas() const { return areas_; }

    [[nodiscard]] const LocalStructure& local(AreaId id) const {
        return locals_[static_cast<std::size_t>(id)];
    }

    [[nodiscard]] const TracedTree& global_tree() const { return global_tree_; }

    [[nodiscard]] const AnyRegionIndex& index() const { return index_; }

    [[nodiscard]] const AcceleratorParams& params() const { return params_; }

    /// O(areas).
    [[nodiscard]] AcceleratorMemory measure_memory() const;

private:
    friend class AreaHandle;
    friend class detail::AcceleratorBuilder;

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

    /// An area with a grid, and what its rays share.
    struct Gridded {
        AreaId area{};
        Pencil pencil;
    };

    /// Whether nothing of the areas concerns the ray, so that the global tree answers.
    [[nodiscard]] bool is_of_no_area(const Ray& ray) const {
        if (any_tree_) return false;
        for (const Gridded& gridded : with_grid_)
            if (gridded.pencil.holds(ray)) return false;
        return true;
    }

    /// The tree over everything where it alone answers all of the rays, else null.
    [[nodiscard]] const WideBvh* tree_of(std::span<const Ray> rays) const;

    /// The areas to ask for a valid ray, best first.
    [[nodiscard]] Candidates candidates_of(const Ray& ray) const;

    /// That area, if the ray starts in it, whether or not it is affine.
    [[nodiscard]] Candidates candidates_in(AreaId area, const Ray& ray) const;

    /// End of the interval of the ray that the area's tree can prove; at most 0 if it proves none.
    [[nodiscard]] float proven_end(AreaId area, const Ray& ray) const;

    [[nodiscard]] bool is_cheaper(const Candidate& a, const Candidate& b) const;
    [[nodiscard]] bool is_better(const Candidate& a, const Candidate& b, float t_max) const;

    /// Asks the area's grid: unknown when there is none, or the ray is not of its pencil.
    template <class Observer>
    Verdict closest_in_grid(AreaId area, const Ray& ray, Hit& hit, Observer& seen) const;
    template <class Observer>
    Verdict any_in_grid(AreaId area, const Ray& ray, Observer& seen) const;

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
    std::vector<Gridded> with_grid_; ///< by ascending area
    bool any_tree_ = false;          ///< whether some area has one, so that a search may pay
    AnyRegionIndex index_;
    TracedTree global_tree_;
};

/// One area of an accelerator: its queries skip the search for the area and the test of affinity.
/// The answers are exact for any ray, also one that has nothing to do with the area. Rays that the
/// area's pencil holds (see pencil()) are the fast ones.
class AreaHandle {
public:
    /// `id` must be one of the owner's areas.
    AreaHandle(const Accelerator& owner, AreaId id)
        : owner_(&owner), grid_(owner.local(id).grid.get()), id_(id) {}

    [[nodiscard]] AreaId id() const { return id_; }

    [[nodiscard]] const InfluenceArea& area() const;

    /// What the exact rays of the area share; rays are recognized bit for bit, so make them with
    /// pencil().shadow_ray or along pencil().direction(). Throws Error for an area that is not
    /// exact.
    [[nodiscard]] const Pencil& pencil() const;

    /// What was built for the area, and why.
    [[nodiscard]] const StructureChoice& choice() const;

    /// The same for people: a few lines.
    [[nodiscard]] std::string explain() const;

    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray) const;
    [[nodiscard]] bool any_hit(const Ray& ray) const;
    template <QueryObserver Observer>
    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray, Observer& seen) const;
    template <QueryObserver Observer>
    [[nodiscard]] bool any_hit(const Ray& ray, Observer& seen) const;

    /// any_hit(pencil().shadow_ray(point, t_min, surface)): the fastest way to ask for one point.
    /// Throws Error for an area that is not exact.
    [[nodiscard]] bool occluded(const Vec3& point, float t_min = 0, PrimId surface = no_prim) const;

    /// See Accelerator::closest_hits. Fastest when the pencil holds every ray: a grid then answers
    /// several at a time, and an inversion a large batch at once. Where a grid and the tree over
    /// everything could answer a large batch, both begin and the faster one goes on.
    void closest_hits(
        std::span<const Ray> rays,
        std::span<Hit> hits,
        const Executor& executor = serial_executor()
    ) const;

    /// See Accelerator::any_hits and closest_hits.
    void any_hits(
        std::span<const Ray> rays,
        std::span<bool> occluded,
        const Executor& executor = serial_executor()
    ) const;

    /// shadowed[i] tells whether something stands between points[i] and the emitter: a ray
    /// against the direction of a parallel area, or to the eye of a radial one. It starts `offset`
    /// (scene units, >= 0) away from the point, so that the surface under the point does not count;
    /// a radial ray shorter than that is not shadowed. Blurred emitters count by their middle.
    /// Throws Error for areas of uniform or measured rays, which have no emitter, and when the
    /// sizes differ.
    void occluded(
        std::span<const Vec3> points,
        std::span<bool> shadowed,
        float offset = 0,
        const Executor& executor = serial_executor()
    ) const;

    /// The same, where the surface under points[i] is the triangle surfaces[i], or no_prim.
    void occluded(
        std::span<const Vec3> points,
        std::span<const PrimId> surfaces,
        std::span<bool> shadowed,
        const Executor& executor = serial_executor()
    ) const;

private:
    [[nodiscard]] const LocalStructure& structure() const;

    [[nodiscard]] TraceMode trace_mode() const;

    /// The wide tree over all triangles that answers what the grid does not, or null when there is
    /// more to it than one tree.
    [[nodiscard]] const WideBvh* whole_tree() const;

    [[nodiscard]] std::optional<Hit> closest_hit_by_trees(const Ray& ray) const;
    [[nodiscard]] bool any_hit_by_trees(const Ray& ray) const;

    template <class Answer, class ByGrid, class ByWhole, class ByTrees>
    void answer_batch(
        std::span<const Ray> rays,
        std::span<Answer> answers,
        const Executor& executor,
        const ByGrid& by_grid,
        const ByWhole& by_whole,
        const ByTrees& by_trees
    ) const;

    /// Whether the area's pencil holds every ray.
    [[nodiscard]] bool are_exact(std::span<const Ray> rays, const Executor& executor) const;

    /// Whether a batch of so many exact rays is cheaper drawn over than traced one by one.
    [[nodiscard]] bool is_worth_drawing(std::size_t rays) const;

    const Accelerator* owner_;
    const PencilGrid* grid_; ///< the area's, or null
    AreaId id_;
};

/// Builds the global tree, the region index, and for each area what its use asks for or what is
/// predicted to be cheapest in total, build and rays. Names must differ, and params.uses must name
/// areas. Coordinates must be finite and within `max_coordinate`. Throws Error
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
