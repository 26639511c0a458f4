#include "analysis/comparison/protocol.hpp"

#include <raywise/analysis/comparison.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/distribution/ray_distribution.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/build_tree.hpp>
#include <raywise/toplevel/membership.hpp>
#include <raywise/toplevel/region_index.hpp>
#include <raywise/toplevel/region_octree.hpp>

#include <variant>

namespace raywise {

Heuristic local_heuristic(Variant variant, const CompareParams& params) {
    Heuristic heuristic = params.heuristic;
    heuristic.measure = variant.measure;
    heuristic.axes = variant.axes;
    if (!params.faithful) return heuristic;
    heuristic.builder = BuilderKind::guided;
    heuristic.measure_mode = MeasureMode::thesis;
    heuristic.guided = {};
    heuristic.guided.faithful = true;
    heuristic.guided.quality_threshold = variant.axes == Variant::Axes::longest ? 0.99F : 0.4F;
    return heuristic;
}

namespace detail {

Variant baseline_of(const CompareParams& params) {
    if (!params.faithful) return strong_baseline;
    return {Variant::Measure::surface, Variant::Axes::longest};
}

Heuristic global_heuristic(const CompareParams& params) {
    if (!params.faithful) {
        Heuristic heuristic = params.heuristic;
        heuristic.measure = MeasureKind::surface;
        heuristic.axes = AxisChoice::all;
        return heuristic;
    }
    Heuristic heuristic = local_heuristic(baseline_of(params), params);
    heuristic.guided.quality_threshold = 0.4F;
    return heuristic;
}

MembershipParams membership_of(const CompareParams& params) {
    MembershipParams membership;
    if (params.faithful) membership.rule = Membership::vertices;
    return membership;
}

AcceleratorParams baseline_structure(const CompareParams& params) {
    AcceleratorParams structure = two_binary_levels();
    structure.local = local_heuristic(baseline_of(params), params);
    structure.global = global_heuristic(params);
    structure.membership = membership_of(params);
    if (params.faithful) {
        structure.mode = QueryMode::first_hit_wins;
        structure.index.kind = RegionIndexKind::octree;
        structure.index.octree.mode = OctreeMode::over;
    }
    return structure;
}

InfluenceArea prepared(InfluenceArea area, const CompareParams& params) {
    const auto* radial = std::get_if<RadialDistribution>(&area.distribution);
    if (!params.faithful || radial == nullptr || !radial->params().window) return area;
    RadialParams rays = radial->params();
    rays.emission = Emission::yaw_pitch;
    area.distribution = RadialDistribution(rays);
    return area;
}

} // namespace detail

} // namespace raywise
