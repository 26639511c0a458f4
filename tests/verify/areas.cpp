// The accelerator with random influence areas of all kinds, against one plain tree over everything.
#include "support/random_areas.hpp"
#include "verify/checks.hpp"

#include <raywise/toplevel/accelerator.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
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
    return params;
}

constexpr std::uint64_t rays_per_scene = 1024;

Outcome check_scene(std::uint64_t seed, std::uint64_t index) {
    Rng rng(seed, index);
    const Scene scene = random_soup(rng, 1 + rng.below(256));
    const std::vector<InfluenceArea> areas = random_areas(rng, 1 + rng.below(8));
    const Accelerator accelerator = build_accelerator(scene, areas, random_params(rng));
    const Bvh tree = build_tree(build_input_of(scene.view()), surface_area_heuristic()).tree;
    const PackedTriangles triangles(tree, scene.view());
    Outcome outcome;
    for (; outcome.rays < rays_per_scene; ++outcome.rays) {
        const Ray ray = random_ray(rng, scene, areas);
        const auto expected = closest_hit(tree, triangles, ray);
        const AreaHandle handle = accelerator[to_area(rng.below(areas.size()))];
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
