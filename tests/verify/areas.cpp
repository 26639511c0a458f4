// The accelerator with random influence areas of all kinds, traced through all kinds of structures,
// against one plain tree over everything.
#include "support/random_areas.hpp"
#include "verify/checks.hpp"

#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/pencil_of.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <variant>
#include <vector>

namespace raywise::verify {

namespace {

using namespace test_support;

bool is_same(const std::optional<Hit>& a, const std::optional<Hit>& b) {
    if (!a || !b) return a.has_value() == b.has_value();
    return a->t == b->t && a->prim == b->prim;
}

AcceleratorParams random_params(Rng& rng) {
    constexpr std::array kinds{
        RegionIndexKind::list, RegionIndexKind::octree, RegionIndexKind::bvh
    };
    AcceleratorParams params;
    params.max_candidates = 1 + static_cast<int>(rng.below(8));
    params.index.kind = kinds[rng.below(3)];
    params.index.octree.max_level = 3;
    if (rng.below(2) == 0) params.local.measure = MeasureKind::surface;
    if (rng.below(2) == 0) params.quality = TreeQuality::fast;
    return params;
}

/// One that the area may have, each as likely.
StructureKind random_structure(Rng& rng, const InfluenceArea& area) {
    std::vector kinds{StructureKind::none, StructureKind::binary_tree, StructureKind::wide_tree};
    if (std::holds_alternative<ParallelDistribution>(area.distribution))
        kinds.push_back(StructureKind::framed_tree);
    if (pencil_of(area)) {
        kinds.push_back(StructureKind::pencil_grid);
        kinds.push_back(StructureKind::inversion);
    }
    return kinds[rng.below(kinds.size())];
}

/// A ray of the area's pencil, if it has one, else any: from a vertex or elsewhere, to the emitter
/// or away from it.
Ray some_ray(
    Rng& rng,
    const AreaHandle& handle,
    const Scene& scene,
    const std::vector<InfluenceArea>& areas
) {
    Ray ray = random_ray(rng, scene, areas);
    const std::optional<Pencil> pencil = pencil_of(handle.area());
    if (!pencil || rng.below(2) == 0) return ray;
    const bool is_parallel = pencil->kind() == Pencil::Kind::parallel;
    const Vec3 point =
        rng.below(2) == 0 ? scene.vertices[rng.below(scene.vertices.size())] : ray.origin;
    if (rng.below(2) == 0) return pencil->shadow_ray(point, ray.t_min, ray.excluded);
    ray.origin = is_parallel ? point : pencil->apex();
    ray.direction = is_parallel ? pencil->direction() : point - pencil->apex();
    return ray;
}

constexpr std::uint64_t rays_per_scene = 1024;

Outcome check_scene(std::uint64_t seed, std::uint64_t index) {
    Rng rng(seed, index);
    const Scene scene = random_soup(rng, 1 + rng.below(256));
    const std::vector<InfluenceArea> areas = random_areas(rng, 1 + rng.below(8));
    AcceleratorParams params = random_params(rng);
    for (const InfluenceArea& area : areas)
        params.uses[area.name].structure = random_structure(rng, area);
    const Accelerator accelerator = build_accelerator(scene, areas, params);
    const Bvh tree = build_tree(build_input_of(scene.view()), surface_area_heuristic()).tree;
    const PackedTriangles triangles(tree, scene.view());
    Outcome outcome;
    for (; outcome.rays < rays_per_scene; ++outcome.rays) {
        const AreaHandle handle = accelerator[to_area(rng.below(areas.size()))];
        const Ray ray = some_ray(rng, handle, scene, areas);
        const auto expected = closest_hit(tree, triangles, ray);
        const bool right = is_same(accelerator.closest_hit(ray), expected) &&
                           accelerator.any_hit(ray) == expected.has_value() &&
                           is_same(handle.closest_hit(ray), expected) &&
                           handle.any_hit(ray) == expected.has_value();
        if (right) continue;
        ++outcome.wrong;
        std::fprintf(
            stderr,
            "areas: scene %llu, ray %llu is wrong\n",
            static_cast<unsigned long long>(index),
            static_cast<unsigned long long>(outcome.rays)
        );
    }
    return outcome;
}

} // namespace

Outcome check_areas(const Options& options) {
    return for_scenes(options, rays_per_scene, [&](std::uint64_t index) {
        return check_scene(options.seed, index);
    });
}

} // namespace raywise::verify
