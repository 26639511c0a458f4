// Random influence areas of all kinds, soups of triangles, and rays that try them hard.
#pragma once

#include "support/random_regions.hpp"

#include <raywise/core/error.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/scene/scene.hpp>

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace raywise::test_support {

inline Scene soup_of(const std::vector<Triangle>& triangles) {
    Scene scene;
    for (const Triangle& t : triangles) {
        const auto first = static_cast<std::uint32_t>(scene.vertices.size());
        scene.vertices.insert(scene.vertices.end(), {t.v0, t.v1, t.v2});
        scene.triangles.push_back({first, first + 1, first + 2});
    }
    return scene;
}

/// Some triangles twice, so that ties are decided by id.
inline Scene random_soup(Rng& rng, std::size_t count) {
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i < count; ++i) {
        triangles.push_back(
            i > 0 && rng.below(10) == 0 ? triangles[rng.below(i)] : random_triangle(rng)
        );
    }
    return soup_of(triangles);
}

inline Distribution random_distribution(Rng& rng, const Region& region) {
    const Vec3d direction = random_direction(rng);
    switch (rng.below(4)) {
    case 0:
        return UniformDistribution(Aabb{{-6, -6, -6}, {6, 6, 6}});
    case 1: {
        MeasuredParams rays;
        rays.bounds = {{-6, -6, -6}, {6, 6, 6}};
        for (int i = 0; i < 20; ++i) {
            rays.rays.push_back(
                {{to_float(random_point(rng, -6, 6)), to_float(random_direction(rng))}, 1}
            );
        }
        return MeasuredDistribution(std::move(rays));
    }
    case 2:
        return ParallelDistribution(
            {.point = random_point(rng, -5, 5),
             .frame = frame_along(direction),
             .half_width = 5,
             .half_height = 5}
        );
    default: {
        const auto* frustum = std::get_if<Frustum>(&region);
        return RadialDistribution(
            {.eye = frustum ? frustum->eye : random_point(rng, -5, 5),
             .frame = frustum ? frustum->frame : frame_along(direction),
             .window = RadialWindow{1, 1},
             .emission = Emission::pinhole}
        );
    }
    }
}

/// Overlapping, identical, flat and faraway ones among them; every ray that starts inside is affine
/// in half of them.
inline std::vector<InfluenceArea> random_areas(Rng& rng, std::size_t count) {
    std::vector<InfluenceArea> areas;
    for (std::size_t i = 0; i < count; ++i) {
        Region region = random_region(rng);
        if (i > 0 && rng.below(8) == 0) region = areas[rng.below(i)].region;
        areas.push_back(
            {.name = "area " + std::to_string(i),
             .region = region,
             .distribution = random_distribution(rng, region),
             .affinity = {.angle_deg = rng.below(2) == 0 ? 90.0 : 20.0}}
        );
    }
    return areas;
}

/// An origin in a region, on its border or anywhere; a direction of any length, along an axis, to a
/// vertex, or along a distribution; an interval that may start late and end early.
inline Ray random_ray(Rng& rng, const Scene& scene, const std::vector<InfluenceArea>& areas) {
    Ray ray;
    const Region* region = areas.empty() ? nullptr : &areas[rng.below(areas.size())].region;
    const auto some_vertex = [&] { return scene.vertices[rng.below(scene.vertices.size())]; };
    ray.origin = to_float(random_point(rng, -8, 8));
    if (region != nullptr) {
        const Aabb box = bounds(*region);
        switch (rng.below(6)) {
        case 0:
            ray.origin = box.vertex(static_cast<int>(rng.below(8)));
            break;
        case 1:
            ray.origin = some_vertex();
            break;
        case 2:
            break;
        default:
            for (int k = 0; k < 20 && !contains(*region, to_double(ray.origin)); ++k) {
                for (int axis = 0; axis < 3; ++axis) {
                    ray.origin[axis] = static_cast<float>(rng.uniform(
                        static_cast<double>(box.lo[axis]), static_cast<double>(box.hi[axis])
                    ));
                }
            }
        }
    }
    const double size = std::exp2(rng.uniform(-10, 10));
    switch (rng.below(6)) {
    case 0:
        ray.direction = some_vertex() - ray.origin;
        break;
    case 1:
        ray.direction = {0, 0, 0};
        ray.direction[static_cast<int>(rng.below(3))] = rng.below(2) == 0 ? 1.0F : -1.0F;
        break;
    case 2:
        if (!areas.empty()) {
            ray.direction = sample(areas[rng.below(areas.size())].distribution, rng).direction;
            break;
        }
        [[fallthrough]];
    default:
        ray.direction = to_float(random_direction(rng) * size);
    }
    if (ray.direction == Vec3{}) ray.direction = {0, 1, 0};
    const double scale = length(to_double(ray.direction));
    if (rng.below(3) == 0) ray.t_min = static_cast<float>(rng.uniform(0, 4) / scale);
    if (rng.below(2) == 0) {
        ray.t_max = ray.t_min + static_cast<float>(rng.uniform(0, 12) / scale);
    }
    if (rng.below(8) == 0) ray.excluded = to_prim(rng.below(scene.triangles.size()));
    return ray;
}

} // namespace raywise::test_support
