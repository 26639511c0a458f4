// Closed meshes, turned at random and scaled from 1e-20 to 1e15, leak nothing: a ray from inside
// hits something, wherever it goes; most go to vertices and edges.
#include "support/closed_mesh.hpp"
#include "support/median_split.hpp"
#include "verify/checks.hpp"

#include <raywise/build/binned.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

namespace raywise::verify {

namespace {

using namespace test_support;

enum class Shape : std::uint8_t { sphere, torus, box };

ClosedMesh make_mesh(Shape shape, Rng& rng) {
    const auto up_to = [&](std::uint64_t count) {
        return static_cast<std::uint32_t>(rng.below(count));
    };
    switch (shape) {
    case Shape::sphere:
        return icosphere(static_cast<int>(up_to(4)));
    case Shape::torus:
        return test_support::torus(8 + up_to(25), 5 + up_to(12));
    case Shape::box:
        break;
    }
    return grid_box(1 + up_to(8));
}

/// A point well inside the mesh: within 0.3 of the center, or of the torus's center circle 0.1.
Vec3d inner_point(Shape shape, Rng& rng) {
    const Vec3d p{rng.uniform(-0.17, 0.17), rng.uniform(-0.17, 0.17), rng.uniform(-0.17, 0.17)};
    if (shape != Shape::torus) return rng.below(4) == 0 ? Vec3d{} : p;
    const double angle = rng.uniform(0, 2 * std::numbers::pi);
    // The inscribed polygon of 8 sides stays 0.08 inside the circle.
    return Vec3d{0.96 * std::cos(angle), 0.96 * std::sin(angle), 0} + p * 0.4;
}

constexpr std::uint64_t rays_per_scene = 2000;

Outcome check_scene(std::uint64_t seed, std::uint64_t index) {
    Rng rng(seed, index);
    const auto shape = static_cast<Shape>(rng.below(3));
    const ClosedMesh mesh = make_mesh(shape, rng);
    const double scale = std::pow(10.0, rng.uniform(-20, 15));
    // A third stays aligned to the axes.
    const bool turned = rng.below(3) != 0;
    const Frame frame = frame_along(
        {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.01, 1)}, rng.uniform(0, 6)
    );
    const auto place = [&](Vec3d p) {
        const Vec3d q = turned ? frame.right * p.x + frame.up * p.y + frame.forward * p.z : p;
        return to_float(q * scale);
    };
    std::vector<Vec3> vertices;
    for (const Vec3d& p : mesh.vertices)
        vertices.push_back(place(p));
    const TriangleView view(vertices, mesh.corners);
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < view.size(); ++i)
        boxes.push_back(bounds(view[to_prim(i)]));
    const Bvh tree = index % 2 == 0 ? median_split(view) : build_binned(boxes, SurfaceMeasure{});
    const IndexedTriangles triangles(view);

    Outcome outcome;
    for (; outcome.rays < rays_per_scene; ++outcome.rays) {
        Ray ray;
        ray.origin = place(inner_point(shape, rng));
        const Triangle target = view[to_prim(static_cast<std::size_t>(rng.below(view.size())))];
        const auto weight = static_cast<float>(rng.below(65)) / 64;
        switch (rng.below(5)) {
        case 0:
        case 1:
            ray.direction = target.v0 - ray.origin;
            break;
        case 2:
        case 3:
            ray.direction = target.v0 * (1 - weight) + target.v1 * weight - ray.origin;
            break;
        default:
            ray.direction = {rng.uniform() - 0.5F, rng.uniform() - 0.5F, rng.uniform() - 0.5F};
            if (rng.below(4) == 0) ray.direction.x = ray.direction.y = 0;
        }
        if (!is_valid(ray)) continue;
        if (closest_hit(tree, triangles, ray) && any_hit(tree, triangles, ray)) continue;
        ++outcome.wrong;
        std::fprintf(
            stderr,
            "leaks: scene %llu, ray %llu leaves through the mesh\n",
            static_cast<unsigned long long>(index),
            static_cast<unsigned long long>(outcome.rays)
        );
    }
    return outcome;
}

} // namespace

Outcome check_leaks(const Options& options) {
    return for_scenes(options, rays_per_scene, [&](std::uint64_t index) {
        return check_scene(options.seed, index);
    });
}

} // namespace raywise::verify
