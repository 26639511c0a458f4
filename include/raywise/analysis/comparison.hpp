// Which heuristic and which structure is best for these rays: every variant on the same triangles
// and the same rays, answers checked before anything is timed, and an honest verdict.
// After [Falcone24]; the protocol (pairing, seeds, intervals, a strong baseline) is ours.
#pragma once

#include <raywise/analysis/memory.hpp>
#include <raywise/analysis/statistics.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/build_tree.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raywise {

/// A pair of heuristics: how boxes are weighed and which axes are tried.
struct Variant {
    using Measure = MeasureKind;
    using Axes = AxisChoice;

    Measure measure = Measure::surface;
    Axes axes = Axes::all;

    friend bool operator==(const Variant&, const Variant&) = default;
};

/// "SAH", "PAH", "PAH+SAH" or "RAYS", then "/longest", "/facing" or "/all".
[[nodiscard]] std::string name_of(Variant variant);

/// The strong baseline: surface area, all three axes.
inline constexpr Variant strong_baseline{Variant::Measure::surface, Variant::Axes::all};

/// SAH and PAH by longest, facing and all axes, the mix and the counted rays by all axes.
[[nodiscard]] std::vector<Variant> default_variants();

/// The four pairs of the thesis, in its order: PAH+SPFH, SAH+SPFH, PAH+LSPH, SAH+LSPH.
[[nodiscard]] std::vector<Variant> faithful_variants();

struct CompareParams {
    std::vector<Variant> variants = default_variants(); ///< the baseline is added if absent
    std::size_t rays = 20'000;     ///< per area and seed, drawn from the area; in [1, 10^8]
    int seeds = 5;                 ///< independent ray sets, in [1, 1000]
    std::uint64_t seed = 1;        ///< of the first set
    int repeats = 5;               ///< timed passes per variant and set; 0: no timing; at most 1000
    std::size_t timed_rays = 4096; ///< of each set, the first so many are timed; >= 1
    double brute_force_budget = 5e7; ///< triangle tests spent on checking answers per area; >= 0
    bool faithful = false;           ///< as the thesis: see `faithful_params`
    Heuristic heuristic;     ///< of every variant, apart from its measure and axes; not used when
                             ///< faithful
    CostConstants constants; ///< of the reported costs
};

/// How a comparison with these parameters builds the variant's local trees.
[[nodiscard]] Heuristic local_heuristic(Variant variant, const CompareParams& params);

/// The thesis's protocol: its four pairs through the guided builder with its faults, thresholds 0.4
/// for facing and 0.99 for longest axes, 1000 rays of one seed (yaw-pitch for radial areas with a
/// window), local triangles by vertex membership, the first local hit wins and a local miss
/// restarts, a global tree by SAH and longest axis with threshold 0.4, no timing. The baseline is
/// SAH/longest. Wrong answers of that rule are reported, not counted as mismatches. [Falcone24]
[[nodiscard]] CompareParams faithful_params();

/// One variant's tree over one area's triangles, traced by that area's rays. Costs are per ray, in
/// box tests; intervals are over seeds.
struct ComparisonRow {
    std::size_t area = 0; ///< index into Comparison::areas
    Variant variant;
    bool is_baseline = false; ///< the strong baseline of the area

    std::size_t triangles = 0;
    std::size_t nodes = 0;
    std::size_t leaves = 0;
    int depth = 0; ///< of the deepest node, the root's being 0
    MemoryUse memory;
    double build_ms = 0; ///< median of the repeats; 0 without timing

    double estimated_cost = 0;       ///< by the area's own measure, per emitted ray
    double estimated_cost_sah = 0;   ///< by the surface area, per ray that hits the root
    ConfidenceInterval real_cost;    ///< counted: unordered, unpruned
    double estimate_error = 0;       ///< of estimated_cost
    double estimate_error_sah = 0;   ///< of estimated_cost_sah
    ConfidenceInterval hits_per_ray; ///< box hits + triangle tests of that traversal
    double overlap = 0; ///< sibling overlap over all levels, clipped to the rays that exist
    double overlap_unculled = 0;  ///< the same without clipping
    double end_point_overlap = 0; ///< EPO [Aila13]

    ConfidenceInterval box_tests; ///< ordered, pruned closest hit
    ConfidenceInterval node_visits;
    ConfidenceInterval prim_tests;
    ConfidenceInterval ordered_cost; ///< C_node box tests + C_prim triangle tests
    double ordered_cost_median = 0;
    double ordered_cost_percentile_95 = 0;
    ConfidenceInterval any_hit_cost;  ///< the same sum for any hit
    ConfidenceInterval ns_per_ray;    ///< closest hit, one thread; 0 without timing
    ConfidenceInterval ordered_ratio; ///< ordered_cost over that of the strong baseline on the same
                                      ///< triangles, same rays; geometric mean
    ConfidenceInterval ns_ratio;      ///< ns_per_ray over the same; 1 without timing

    ConfidenceInterval full_cost;  ///< this tree, then the global one where it cannot answer alone
    ConfidenceInterval full_ratio; ///< full_cost over the global tree alone, same rays
    ConfidenceInterval full_ns;    ///< of the whole query; 0 without timing
    ConfidenceInterval full_ns_ratio; ///< full_ns over the global tree alone; 1 without timing
    double restart_cost = 0; ///< the thesis's metric: unpruned local, plus unpruned global after a
                             ///< local miss
    std::optional<double> break_even_hit_fraction; ///< share of rays it must answer alone to pay
    std::optional<double> break_even_rays; ///< until its build is earned back against the global
                                           ///< tree; nullopt: never, or no timing
    ConfidenceInterval shadow_ratio;       ///< any-hit cost of the whole query over the global tree
                                     ///< alone, for the segments from where the area's rays end
                                     ///< back to where they start; 1 without hits
    double wrong_fraction = 0;    ///< faithful only: rays that the thesis's rule answers wrongly
    GuidedReport build_work;      ///< of the guided builder (faithful); zero otherwise
    std::uint64_t mismatches = 0; ///< wrong answers; anything above 0 is a failed run
};

/// What holds for an area whatever the variant.
struct AreaSummary {
    enum class Verdict : std::uint8_t {
        local_structure, ///< `winner`, then the global tree, beats the global tree alone
        no_difference,   ///< the interval of the ratio holds 1: not worth a second structure
        global_tree,     ///< the global tree alone is faster
    };

    std::string name;
    std::size_t triangles = 0;        ///< of the local structure
    double root_probability = 0;      ///< of an emitted ray to hit the box of the local triangles
    double hit_fraction = 0;          ///< rays with a hit anywhere
    double answered_fraction = 0;     ///< rays that need no continuation
    double local_hit_fraction = 0;    ///< rays whose final hit the local structure found
    double continuation_fraction = 0; ///< rays that go on in the global tree
    double continuation_hit_fraction = 0; ///< of those, the share that finds a hit there
    double continuation_cost = 0;         ///< ordered cost per continued ray
    ConfidenceInterval global_cost;      ///< ordered cost of the global tree alone, the area's rays
    ConfidenceInterval global_real_cost; ///< counted, unordered, unpruned
    ConfidenceInterval global_ns;        ///< 0 without timing
    std::uint64_t checked_by_brute_force = 0; ///< rays
    std::size_t winner = 0; ///< index into Comparison::rows of the least full_ratio: by counts
    /// By the winner's full_ns_ratio when timed, else by its full_ratio.
    Verdict verdict = Verdict::global_tree;
};

/// A variant over all areas.
struct VariantSummary {
    Variant variant;
    double ordered_ratio = 1; ///< geometric mean over the areas
    double full_ratio = 1;
    std::size_t wins = 0; ///< areas in which full_ratio < 1 with 95 % confidence
};

/// The region index over all areas.
struct IndexSummary {
    std::size_t areas = 0;
    std::size_t octree_nodes = 0;
    std::size_t octree_leaves = 0;
    int octree_depth = 0;
    double octree_mean_list = 0; ///< areas per leaf
    std::size_t octree_max_list = 0;
    std::size_t octree_bytes = 0;
    double octree_build_ms = 0; ///< 0 without timing, as the next two
    double list_ns = 0;         ///< per point query
    double octree_ns = 0;
};

struct Comparison {
    std::string scene;
    std::uint64_t scene_hash = 0;
    std::size_t triangles = 0;
    std::size_t degenerate_triangles = 0;
    CompareParams params; ///< as used, the baseline among the variants
    double global_build_ms = 0;
    std::size_t global_nodes = 0;
    int global_depth = 0;
    MemoryUse global_memory;
    IndexSummary index;
    std::vector<AreaSummary> areas;
    std::vector<ComparisonRow> rows; ///< area by area, each in the order of params.variants
    std::vector<VariantSummary> variants;
    std::uint64_t mismatches = 0; ///< sum over the rows
};

/// One line for people about area `area` < areas.size(): "use the global BVH: ...", "use SAH/all:
/// ...", "no difference: ...".
[[nodiscard]] std::string verdict_text(const Comparison& comparison, std::size_t area);

/// Compares the variants on every area. The scene needs a triangle and the list an area; throws
/// Error otherwise, and for parameters out of range. Counts are the same for any number of threads;
/// times are taken on one thread, interleaved. Memory O(rays + triangles).
[[nodiscard]] Comparison compare(
    const Scene& scene,
    std::span<const InfluenceArea> areas,
    const CompareParams& params = {},
    const Executor& executor = serial_executor(),
    const Progress& progress = {}
);

} // namespace raywise
