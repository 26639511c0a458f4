#include "analysis/workload/eye.hpp"
#include "analysis/workload/path_tracer.hpp"
#include "analysis/workload/place.hpp"

#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raywise::workload_detail {

namespace {

constexpr std::size_t rays_per_chunk = tile_paths * 16;

template <class Work>
void for_each(const Executor& executor, std::size_t count, const Work& work) {
    executor.for_each_chunk(count, rays_per_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            work(i);
    });
}

SurfacePoint surface_point(const Scene& scene, const Ray& ray, const Hit& hit) {
    if (hit.prim == no_prim) return {};
    const Triangle triangle = scene.view()[hit.prim];
    const Vec3d a = to_double(triangle.v0);
    const Vec3d normal = cross(to_double(triangle.v1) - a, to_double(triangle.v2) - a);
    const double size = length(normal);
    if (!(size > 0)) return {};
    const Vec3d direction = to_double(ray.direction);
    const Vec3d point = to_double(ray.origin) + direction * static_cast<double>(hit.t);
    const double side = dot(normal, direction) > 0 ? -1 : 1;
    return {true, to_float(point), normal * (side / size)};
}

/// Cosine-weighted about the normal.
Vec3 diffuse_direction(Vec3d normal, Rng& rng) {
    const Vec3d direction = normal + sample_sphere(rng);
    const double size = length(direction);
    return to_float(size > 1e-6 ? direction / size : normal);
}

} // namespace

Paths PathTracer::trace(const Eye& eye, std::size_t number, std::size_t count) const {
    Paths paths;
    paths.primary = primary_rays(eye, number, count);
    paths.first = surface_points(paths.primary);
    paths.bounce.resize(count);
    for_each(executor_, count, [&](std::size_t i) {
        if (!paths.first[i].is_there) return;
        Rng rng(seed_of(params_.seed, Stream::bounce, number), i);
        paths.bounce[i] = {
            .origin = paths.first[i].point,
            .direction = diffuse_direction(paths.first[i].normal, rng),
            .t_min = offset()
        };
    });
    paths.second = surface_points(paths.bounce);
    return paths;
}

std::vector<Ray>
PathTracer::lens_rays(const Eye& eye, std::size_t number, std::size_t count, double radius) const {
    std::vector<Ray> rays = primary_rays(eye, number, count);
    for_each(executor_, count, [&](std::size_t i) {
        Rng rng(seed_of(params_.seed, Stream::lens, number), i);
        const Vec2d shift = sample_disk(radius, rng);
        const Vec3d sharp = to_double(rays[i].direction) * eye.focus;
        const Vec3d on_lens = eye.frame.right * shift.x + eye.frame.up * shift.y;
        rays[i].origin = to_float(eye.position + on_lens);
        rays[i].direction = to_float(normalized(sharp - on_lens));
    });
    return rays;
}

std::vector<Ray>
PathTracer::primary_rays(const Eye& eye, std::size_t number, std::size_t count) const {
    const std::size_t tiles = (count + tile_paths - 1) / tile_paths;
    std::vector<Ray> rays(count);
    for_each(executor_, count, [&](std::size_t i) {
        const std::size_t at = i / tile_paths;
        Rng tile_rng(seed_of(params_.seed, Stream::tile, number), at);
        const double share =
            (static_cast<double>(at) + tile_rng.uniform_double()) / static_cast<double>(tiles);
        const auto tile =
            static_cast<std::uint64_t>(share * static_cast<double>(image_tiles * image_tiles));
        Rng rng(seed_of(params_.seed, Stream::pixel, number), i);
        const Vec3d along =
            look_along(eye, std::min(tile, image_tiles * image_tiles - 1), i % tile_paths, rng);
        // Depth 1 along forward, so that the lens finds its focus.
        rays[i] = {.origin = to_float(eye.position), .direction = to_float(along)};
    });
    return rays;
}

std::vector<SurfacePoint> PathTracer::surface_points(std::span<const Ray> rays) const {
    std::vector<Hit> hits(rays.size());
    oracle_.closest_hits(rays, hits, executor_);
    std::vector<SurfacePoint> points(rays.size());
    for_each(executor_, rays.size(), [&](std::size_t i) {
        points[i] = surface_point(*place_.scene, rays[i], hits[i]);
    });
    return points;
}

} // namespace raywise::workload_detail
