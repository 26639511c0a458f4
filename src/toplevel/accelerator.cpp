#include <raywise/toplevel/accelerator.hpp>

#include <raywise/bvh/remap.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>

#include <algorithm>
#include <limits>
#include <set>
#include <string>

namespace raywise {
namespace {

constexpr std::size_t batch = 256; ///< rays per chunk of parallel work

std::size_t index_of(AreaId id) {
    return static_cast<std::size_t>(id);
}

std::size_t bytes_of(const Bvh& tree) {
    return tree.nodes.capacity() * sizeof(Node) + tree.prims.capacity() * sizeof(PrimId);
}

void check(const AcceleratorParams& params) {
    if (params.max_candidates < 1 || params.max_candidates > 8) {
        throw Error("accelerator: max_candidates must be in [1, 8]");
    }
    if (params.gain && (params.gain->rays < 1 || params.gain->rays > 10'000'000)) {
        throw Error("accelerator: gain rays must be in [1, 10^7]");
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

/// A ray of the area that starts somewhere along its way through the region; rays as sampled start
/// on the window, which may lie on the region's border or outside.
Ray sample_inside(const InfluenceArea& area, const Region& wide, Rng& rng) {
    Ray ray = sample(area.distribution, rng);
    const double way = rng.uniform_double();
    if (!contains(wide, to_double(ray.origin))) return ray;
    const auto exit = static_cast<double>(std::min(exit_parameter(wide, ray), ray.t_max));
    const Vec3d start = to_double(ray.origin) + to_double(ray.direction) * (way * exit);
    if (is_finite(start)) ray.origin = to_float(start);
    return ray;
}

/// Cost per ray that the area saves against the global tree alone; negative when it costs more.
double measure_gain(const Accelerator& accelerator, AreaId id, const GainParams& params) {
    const AreaHandle handle = accelerator[id];
    const InfluenceArea& area = handle.area();
    const Region wide = inflated(area.region, 1e-3 * diameter(area.region));
    CountedQuery with_area;
    Counts global_alone;
    for (std::size_t i = 0; i < params.rays; ++i) {
        Rng rng(params.seed, i);
        const Ray ray = sample_inside(area, wide, rng);
        static_cast<void>(handle.closest_hit(ray, with_area));
        static_cast<void>(closest_hit(
            accelerator.global_tree(), accelerator.global_triangles(), ray, global_alone
        ));
    }
    return (cost_of(global_alone) - cost_of(with_area)) / static_cast<double>(params.rays);
}

/// The ray from a lit point to the emitter of an area.
class ShadowRays {
public:
    ShadowRays(const Distribution& distribution, float offset) : offset_(offset) {
        if (!(offset >= 0) || !std::isfinite(offset)) {
            throw Error("occluded: offset must be finite and at least 0");
        }
        if (const auto* parallel = std::get_if<ParallelDistribution>(&distribution)) {
            toward_ = -parallel->params().frame.forward;
        } else if (const auto* radial = std::get_if<RadialDistribution>(&distribution)) {
            toward_ = radial->params().eye;
            is_radial_ = true;
        } else {
            throw Error("occluded: the area has no emitter that shadows point to");
        }
    }

    [[nodiscard]] Ray from(Vec3 point) const {
        Ray ray{.origin = point, .direction = to_float(toward_), .t_min = offset_};
        if (!is_radial_) return ray;
        ray.direction = to_float(toward_ - to_double(point));
        ray.t_max = 1;
        ray.t_min =
            static_cast<float>(static_cast<double>(offset_) / length(to_double(ray.direction)));
        return ray;
    }

private:
    Vec3d toward_; ///< a direction, or the eye
    bool is_radial_ = false;
    float offset_;
};

template <class Query>
void closest_batch(
    const Query& query,
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor
) {
    if (rays.size() != hits.size()) throw Error("closest_hits: as many hits as rays are needed");
    executor.for_each_chunk(rays.size(), batch, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            hits[i] = query.closest_hit(rays[i]).value_or(Hit{});
        }
    });
}

template <class Query>
void any_batch(
    const Query& query,
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor
) {
    if (rays.size() != occluded.size()) {
        throw Error("any_hits: as many answers as rays are needed");
    }
    executor.for_each_chunk(rays.size(), batch, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            occluded[i] = query.any_hit(rays[i]);
        }
    });
}

} // namespace

float Accelerator::proven_end(AreaId area, const Ray& ray) const {
    const float exit = exit_parameter(areas_[index_of(area)].region, ray);
    // A hit's t was rounded: relative to a normal number that is within the margin of membership,
    // below the normal numbers, or from infinity, it might not be.
    if (!(exit >= std::numeric_limits<float>::min())) return 0;
    return std::min(exit, std::numeric_limits<float>::max());
}

bool Accelerator::is_cheaper(const Candidate& a, const Candidate& b) const {
    const double cost_a = local(a.area).expected_cost;
    const double cost_b = local(b.area).expected_cost;
    return cost_a != cost_b ? cost_a < cost_b : a.area < b.area;
}

bool Accelerator::is_better(const Candidate& a, const Candidate& b, float t_max) const {
    if (params_.mode == QueryMode::first_hit_wins) return a.area < b.area;
    const float reach_a = std::min(a.exit, t_max);
    const float reach_b = std::min(b.exit, t_max);
    if (reach_a != reach_b) return reach_a > reach_b;
    return is_cheaper(a, b);
}

Accelerator::Candidates Accelerator::candidates_of(const Ray& ray) const {
    const bool is_exact_mode = params_.mode == QueryMode::exact;
    const std::size_t limit =
        is_exact_mode ? static_cast<std::size_t>(params_.max_candidates) : most_candidates;
    Candidates best;
    visit_areas_at(index_, ray.origin, [&](AreaId id) {
        if (!local(id).is_enabled || !follows(areas_[index_of(id)], ray)) return;
        const Candidate candidate{id, proven_end(id, ray)};
        if (is_exact_mode && candidate.exit <= ray.t_min) return;
        // Insertion into a short sorted list, whose last falls off when it is full.
        std::size_t at = std::min(best.count, limit - 1);
        if (best.count == limit && !is_better(candidate, best.items[at], ray.t_max)) return;
        for (; at > 0 && is_better(candidate, best.items[at - 1], ray.t_max); --at) {
            best.items[at] = best.items[at - 1];
        }
        best.items[at] = candidate;
        best.count = std::min(best.count + 1, limit);
    });
    if (!is_exact_mode) return best;
    // The cheapest first: the later ones only extend what it proves.
    for (std::size_t i = 1; i < best.count; ++i) {
        for (std::size_t k = i; k > 0 && is_cheaper(best.items[k], best.items[k - 1]); --k) {
            std::swap(best.items[k], best.items[k - 1]);
        }
    }
    return best;
}

Accelerator::Candidates Accelerator::candidates_in(AreaId area, const Ray& ray) const {
    Candidates only;
    if (!local(area).is_enabled) return only;
    if (!contains(areas_[index_of(area)].region, to_double(ray.origin))) return only;
    only.items[only.count++] = {area, proven_end(area, ray)};
    return only;
}

std::optional<Hit> Accelerator::closest_hit(const Ray& ray) const {
    SilentQuery nobody;
    return closest_hit(ray, nobody);
}

bool Accelerator::any_hit(const Ray& ray) const {
    SilentQuery nobody;
    return any_hit(ray, nobody);
}

void Accelerator::closest_hits(
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor
) const {
    closest_batch(*this, rays, hits, executor);
}

void Accelerator::any_hits(
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor
) const {
    any_batch(*this, rays, occluded, executor);
}

AreaHandle Accelerator::operator[](std::string_view name) const {
    for (std::size_t i = 0; i < areas_.size(); ++i) {
        if (areas_[i].name == name) return {*this, to_area(i)};
    }
    throw Error("accelerator: no influence area is named '" + std::string(name) + "'");
}

AreaHandle Accelerator::operator[](AreaId id) const {
    if (index_of(id) >= areas_.size()) throw Error("accelerator: no such influence area");
    return {*this, id};
}

AcceleratorMemory Accelerator::measure_memory() const {
    AcceleratorMemory memory;
    memory.global_tree = bytes_of(global_tree_);
    memory.global_triangles = global_triangles_.size_in_bytes();
    for (const LocalStructure& structure : locals_) {
        memory.local_trees += bytes_of(structure.tree);
        memory.local_triangles += structure.triangles.size_in_bytes();
    }
    memory.areas =
        areas_.capacity() * sizeof(InfluenceArea) + locals_.capacity() * sizeof(LocalStructure);
    memory.index = bytes(index_);
    return memory;
}

const InfluenceArea& AreaHandle::area() const {
    return owner_->areas()[index_of(id_)];
}

std::optional<Hit> AreaHandle::closest_hit(const Ray& ray) const {
    SilentQuery nobody;
    return closest_hit(ray, nobody);
}

bool AreaHandle::any_hit(const Ray& ray) const {
    SilentQuery nobody;
    return any_hit(ray, nobody);
}

void AreaHandle::closest_hits(
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor
) const {
    closest_batch(*this, rays, hits, executor);
}

void AreaHandle::any_hits(
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor
) const {
    any_batch(*this, rays, occluded, executor);
}

void AreaHandle::occluded(
    std::span<const Vec3> points,
    std::span<bool> shadowed,
    float offset,
    const Executor& executor
) const {
    if (points.size() != shadowed.size()) {
        throw Error("occluded: as many answers as points are needed");
    }
    const ShadowRays rays(area().distribution, offset);
    executor.for_each_chunk(points.size(), batch, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            shadowed[i] = any_hit(rays.from(points[i]));
        }
    });
}

Accelerator build_accelerator(
    const TriangleView& triangles,
    std::vector<InfluenceArea> areas,
    const AcceleratorParams& params,
    const Executor& executor,
    const Progress& progress
) {
    check(params);
    check_names(areas);
    Accelerator result;
    result.params_ = params;
    result.areas_ = std::move(areas);

    const std::size_t steps = result.areas_.size() + 1;
    progress.step("build", 0, steps);
    result.global_tree_ =
        build_tree(build_input_of(triangles, executor), params.global, executor).tree;
    result.global_triangles_ = PackedTriangles(result.global_tree_, triangles);

    std::vector<Region> regions;
    for (const InfluenceArea& area : result.areas_)
        regions.push_back(area.region);
    result.index_ = build_region_index(regions, params.index);
    result.build_locals(triangles, executor, progress);
    progress.step("build", steps, steps);
    return result;
}

void Accelerator::build_locals(
    const TriangleView& triangles,
    const Executor& executor,
    const Progress& progress
) {
    locals_.clear();
    for (const InfluenceArea& area : areas_) {
        progress.step("build", 1 + locals_.size(), areas_.size() + 1);
        const auto members = members_of(triangles, area.region, params_.membership, executor);
        LocalStructure structure;
        structure.tree = build_tree(
                             build_input_of(triangles, members, executor),
                             area.distribution,
                             params_.local,
                             executor
        )
                             .tree;
        remap_prims(structure.tree, members);
        structure.triangles = PackedTriangles(structure.tree, triangles);
        structure.expected_cost = expected_cost(structure.tree, area, params_.local.binned.cost);
        locals_.push_back(std::move(structure));
    }
    if (!params_.gain) return;
    for (std::size_t i = 0; i < areas_.size(); ++i) {
        LocalStructure& structure = locals_[i];
        structure.gain = measure_gain(*this, to_area(i), *params_.gain);
        structure.is_enabled = *structure.gain > 0;
    }
}

Accelerator Accelerator::with_local_heuristic(
    const Heuristic& local,
    const TriangleView& triangles,
    const Executor& executor,
    const Progress& progress
) const {
    Accelerator result = *this;
    result.params_.local = local;
    result.build_locals(triangles, executor, progress);
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

} // namespace raywise
