// Builds an accelerator: the global tree, then for each area the structure that pays.
#include "toplevel/predicted_costs.hpp"
#include "toplevel/sampled_rays.hpp"

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/bvh/remap.hpp>
#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/distribution/any_measure.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/measured.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/triangle_copy.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil_grid.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/area_id.hpp>
#include <raywise/toplevel/build_tree.hpp>
#include <raywise/toplevel/build_wide.hpp>
#include <raywise/toplevel/membership.hpp>
#include <raywise/toplevel/pencil_of.hpp>
#include <raywise/toplevel/region_index.hpp>
#include <raywise/toplevel/region_octree.hpp>
#include <raywise/toplevel/served.hpp>
#include <raywise/toplevel/structure_choice.hpp>
#include <raywise/trace/observer.hpp>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace raywise {

namespace {

void check(const AcceleratorParams& params) {
    if (params.max_candidates < 1 || params.max_candidates > 8) {
        throw Error("accelerator: max_candidates must be in [1, 8]");
    }
    if (params.gain && (params.gain->rays < 1 || params.gain->rays > 10'000'000)) {
        throw Error("accelerator: gain rays must be in [1, 10^7]");
    }
    if (params.global_structure != StructureKind::binary_tree &&
        params.global_structure != StructureKind::wide_tree) {
        throw Error("accelerator: the global structure is a binary or a wide tree");
    }
    if (params.mode == QueryMode::first_hit_wins) return;
    if (params.membership.rule != Membership::overlap) {
        throw Error("accelerator: membership by vertices gives wrong answers; it needs the mode "
                    "first_hit_wins");
    }
    if (params.index.kind == RegionIndexKind::octree &&
        params.index.octree.mode == OctreeMode::over) {
        throw Error("accelerator: an octree that answers too many areas needs the mode "
                    "first_hit_wins");
    }
}

void check_names(const std::vector<InfluenceArea>& areas) {
    std::set<std::string_view> names;
    for (const InfluenceArea& area : areas) {
        if (!names.insert(area.name).second) {
            throw Error("accelerator: two influence areas are named '" + area.name + "'");
        }
    }
}

void check(const AreaUse& use) {
    if (use.expected_rays && !(*use.expected_rays >= 0)) {
        throw Error("accelerator: expected_rays must be at least 0");
    }
}

void check_uses(const AcceleratorParams& params, const std::vector<InfluenceArea>& areas) {
    check(params.use);
    for (const auto& [name, use] : params.uses) {
        check(use);
        const bool is_known =
            std::any_of(areas.begin(), areas.end(), [&](const InfluenceArea& area) {
                return area.name == name;
            });
        if (!is_known) {
            throw Error("accelerator: no influence area is named '" + name + "', but has a use");
        }
    }
}

/// Expected cost of a ray that hits the root, unordered and unpruned, by the area's own measure.
/// Counted rays would cost O(rays) per node; their areas are judged by surface area.
double expected_cost(const Bvh& tree, const InfluenceArea& area, const CostConstants& constants) {
    if (tree.is_empty()) return 0;
    const auto sum = [&](const auto& measure) {
        const auto root = static_cast<double>(measure(tree.root().box()));
        if (!(root > 0)) return 0.0;
        double cost = 0;
        for (const Node& node : tree.nodes) {
            const double work = node.is_leaf() ? constants.prim * static_cast<double>(node.count())
                                               : 2 * constants.node;
            cost += work * static_cast<double>(measure(node.box())) / root;
        }
        return cost;
    };
    const AnyMeasure measure = measure_of(area.distribution);
    if (std::holds_alternative<MeasuredMeasure>(measure)) return sum(SurfaceMeasure{});
    return std::visit(sum, measure);
}

/// Cost per ray that the area saves against the global tree alone; negative when it costs more.
double measure_gain(const Accelerator& accelerator, AreaId id, const GainParams& params) {
    const AreaHandle handle = accelerator[id];
    CountedQuery with_area;
    CountedQuery global_alone;
    for (const Ray& ray : detail::sampled_rays(handle.area(), params.rays, params.seed)) {
        static_cast<void>(handle.closest_hit(ray, with_area));
        static_cast<void>(accelerator.global_tree().closest_hit(ray, global_alone));
    }
    return (cost_of(global_alone) - cost_of(with_area)) / static_cast<double>(params.rays);
}

} // namespace

namespace detail {

class AcceleratorBuilder {
public:
    AcceleratorBuilder(
        Accelerator& result,
        const TriangleView& triangles,
        const Executor& executor,
        const Progress& progress
    )
        : result_(result), triangles_(triangles), executor_(executor), progress_(progress) {}

    void build_global(const AcceleratorParams& params, std::vector<InfluenceArea> areas) {
        result_.params_ = params;
        result_.areas_ = std::move(areas);
        progress_.step("build", 0, steps());
        result_.global_tree_ =
            params.global_structure == StructureKind::wide_tree
                ? TracedTree(build_wide(triangles_, params.quality, executor_))
                : TracedTree(
                      build_tree(build_input_of(triangles_, executor_), params.global, executor_)
                          .tree,
                      triangles_
                  );
        std::vector<Region> regions;
        regions.reserve(result_.areas_.size());
        for (const InfluenceArea& area : result_.areas_)
            regions.push_back(area.region);
        result_.index_ = build_region_index(regions, result_.params_.index);
    }

    void build_locals() {
        result_.locals_.clear();
        result_.with_grid_.clear();
        for (const InfluenceArea& area : result_.areas_) {
            progress_.step("build", 1 + result_.locals_.size(), steps());
            result_.locals_.push_back(build_local(area));
            if (result_.locals_.back().grid)
                result_.with_grid_.push_back(
                    {to_area(result_.locals_.size() - 1), *result_.locals_.back().pencil}
                );
        }
        if (result_.params_.gain) disable_what_saves_nothing(*result_.params_.gain);
        result_.any_tree_ = std::any_of(
            result_.locals_.begin(),
            result_.locals_.end(),
            [](const LocalStructure& structure) { return structure.has_tree; }
        );
        progress_.step("build", steps(), steps());
    }

private:
    [[nodiscard]] std::size_t steps() const { return result_.areas_.size() + 1; }

    [[nodiscard]] LocalStructure build_local(const InfluenceArea& area) {
        LocalStructure structure;
        structure.pencil = pencil_of(area);
        structure.choice = choose(area, structure);
        if (structure.choice.kind != StructureKind::framed_tree) structure.tree = {};
        switch (structure.choice.kind) {
        case StructureKind::none:
            break;
        case StructureKind::pencil_grid:
            structure.triangles = shared_copy();
            structure.grid = std::make_shared<const PencilGrid>(
                build_pencil_grid(structure.triangles->view(), *structure.pencil, {}, executor_)
            );
            break;
        case StructureKind::inversion:
            structure.triangles = shared_copy();
            break;
        case StructureKind::framed_tree:
            if (structure.tree.is_empty()) structure.tree = framed(area);
            structure.is_whole = true;
            structure.has_tree = true;
            break;
        case StructureKind::binary_tree:
        case StructureKind::wide_tree:
            build_local_tree(structure, area);
            break;
        }
        return structure;
    }

    /// For the structures that read triangles in place.
    [[nodiscard]] std::shared_ptr<const TriangleCopy> shared_copy() {
        if (!copy_)
            copy_ = std::make_shared<const TriangleCopy>(copy_triangles(
                triangles_.size(), [&](std::size_t i) { return triangles_[to_prim(i)]; }, executor_
            ));
        return copy_;
    }

    void build_local_tree(LocalStructure& structure, const InfluenceArea& area) const {
        const AcceleratorParams& params = result_.params_;
        const auto members = members_of(triangles_, area.region, params.membership, executor_);
        structure.has_tree = true;
        if (structure.choice.kind == StructureKind::binary_tree) {
            const BuildInput input = build_input_of(triangles_, members, executor_);
            Bvh tree = build_tree(input, area.distribution, params.local, executor_).tree;
            remap_prims(tree, members);
            structure.expected_cost = expected_cost(tree, area, params.local.binned.cost);
            structure.tree = TracedTree(std::move(tree), triangles_);
        } else {
            const TriangleCopy subset = copy_triangles(
                members.size(), [&](std::size_t i) { return triangles_[members[i]]; }, executor_
            );
            WideBvh tree = build_wide(
                subset.view(),
                area.distribution,
                params.local.surface_share,
                params.quality,
                executor_
            );
            remap_prims(tree, members);
            structure.tree = TracedTree(std::move(tree));
        }
    }

    [[nodiscard]] const AreaUse& use_of(const InfluenceArea& area) const {
        const auto named = result_.params_.uses.find(area.name);
        return named == result_.params_.uses.end() ? result_.params_.use : named->second;
    }

    [[nodiscard]] StructureChoice
    choose(const InfluenceArea& area, LocalStructure& structure) const {
        const AreaUse& use = use_of(area);
        StructureChoice choice;
        const auto triangles = static_cast<double>(triangles_.size());
        choice.expected_rays = use.expected_rays.value_or(10 * triangles);
        if (use.structure) {
            choice.kind = *use.structure;
            choice.is_forced = true;
            check_forced(area, structure, choice.kind);
            return choice;
        }
        choice.predictions.push_back({StructureKind::none, 0, ray_ns(result_.global_tree_, area)});
        if (structure.pencil) {
            choice.predictions.push_back(
                predict_grid(structure.pencil->kind(), triangles, executor_)
            );
            choice.predictions.push_back(
                predict_inversion(structure.pencil->kind(), triangles_.size(), executor_)
            );
        }
        if (!structure.pencil && std::holds_alternative<ParallelDistribution>(area.distribution))
            try_framed(area, structure, choice);
        choice.kind = cheapest(choice.predictions, choice.expected_rays).kind;
        return choice;
    }

    /// A sheared frame makes some scenes a third faster and others slower, and only tracing tells
    /// which: the tree is built when that much would pay, and both are asked the same rays.
    void try_framed(const InfluenceArea& area, LocalStructure& structure, StructureChoice& choice)
        const {
        const double global_ns = choice.predictions.front().ray_ns;
        StructurePrediction framed_tree = predict_framed(triangles_.size(), executor_);
        framed_tree.ray_ns = global_ns * 2 / 3;
        if (framed_tree.total_ns(choice.expected_rays) >= global_ns * choice.expected_rays) return;
        structure.tree = framed(area);
        framed_tree.ray_ns = ray_ns(structure.tree, area);
        choice.predictions.push_back(framed_tree);
        choice.remark = "framed_tree was built and counted on " + std::to_string(sampled) + " rays";
    }

    [[nodiscard]] TracedTree framed(const InfluenceArea& area) const {
        const ParallelParams& rays = std::get<ParallelDistribution>(area.distribution).params();
        return TracedTree(build_framed(
            triangles_,
            to_float(rays.frame.forward),
            rays.cone_half_angle_deg,
            result_.params_.quality,
            executor_
        ));
    }

    static void
    check_forced(const InfluenceArea& area, const LocalStructure& structure, StructureKind kind) {
        const bool is_parallel = std::holds_alternative<ParallelDistribution>(area.distribution);
        if (kind == StructureKind::framed_tree && !is_parallel) {
            throw Error(
                "accelerator: area '" + area.name + "' is not parallel, so it has no frame"
            );
        }
        const bool needs_pencil =
            kind == StructureKind::pencil_grid || kind == StructureKind::inversion;
        if (needs_pencil && !structure.pencil) {
            throw Error(
                "accelerator: area '" + area.name + "' is not exact, so it can have no " +
                std::string(name_of(kind))
            );
        }
    }

    /// Predicted for a shadow ray of the area in a tree over everything.
    [[nodiscard]] double ray_ns(const TracedTree& tree, const InfluenceArea& area) const {
        if (triangles_.size() == 0) return 0;
        CountedQuery counted;
        const std::vector<Ray> rays = sampled_shadow_rays(area, triangles_, sampled, 1);
        for (const Ray& ray : rays)
            static_cast<void>(tree.any_hit(ray, counted));
        return predicted_ns(counted) / static_cast<double>(rays.size());
    }

    void disable_what_saves_nothing(const GainParams& params) {
        for (std::size_t i = 0; i < result_.areas_.size(); ++i) {
            LocalStructure& structure = result_.locals_[i];
            structure.gain = measure_gain(result_, to_area(i), params);
            structure.has_tree = structure.has_tree && *structure.gain > 0;
        }
    }

    static constexpr std::size_t sampled = 1024; ///< rays per prediction

    Accelerator& result_;
    std::shared_ptr<const TriangleCopy> copy_; ///< shared by the areas that draw
    const TriangleView& triangles_;
    const Executor& executor_;
    const Progress& progress_;
};

} // namespace detail

Accelerator build_accelerator(
    const TriangleView& triangles,
    std::vector<InfluenceArea> areas,
    const AcceleratorParams& params,
    const Executor& executor,
    const Progress& progress
) {
    check(params);
    check_names(areas);
    check_uses(params, areas);
    Accelerator result;
    detail::AcceleratorBuilder builder(result, triangles, executor, progress);
    builder.build_global(params, std::move(areas));
    builder.build_locals();
    return result;
}

Accelerator build_accelerator(
    const Scene& scene,
    std::vector<InfluenceArea> areas,
    const AcceleratorParams& params,
    const Executor& executor,
    const Progress& progress
) {
    return build_accelerator(scene.view(), std::move(areas), params, executor, progress);
}

Accelerator Accelerator::with_local_heuristic(
    const Heuristic& local,
    const TriangleView& triangles,
    const Executor& executor,
    const Progress& progress
) const {
    Accelerator result = *this;
    result.params_.local = local;
    detail::AcceleratorBuilder(result, triangles, executor, progress).build_locals();
    return result;
}

} // namespace raywise
