// Clusters of spheres: triangle densities that differ by orders of magnitude.
#include "scene/mesh_builder.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <cmath>
#include <cstdint>
#include <string>

namespace raywise {

namespace {

using scene_detail::MeshBuilder;

constexpr int clusters = 8;
constexpr int spheres_per_cluster = 12;

/// The corners of a cube of 100 m, moved a little.
Vec3d cluster_center(int cluster, std::uint64_t seed) {
    Rng rng(seed, static_cast<std::uint64_t>(cluster));
    const auto coordinate = [&](int bit) {
        return ((cluster & bit) != 0 ? 100.0 : 0.0) + rng.uniform(-15, 15);
    };
    const double x = coordinate(4);
    const double y = coordinate(2);
    return {x, 30 + y, coordinate(1)};
}

void add_clusters(MeshBuilder& mesh, double detail, std::uint64_t seed) {
    for (int cluster = 0; cluster < clusters; ++cluster) {
        mesh.begin_group("cluster " + std::to_string(cluster));
        const Vec3d center = cluster_center(cluster, seed);
        for (int i = 0; i < spheres_per_cluster; ++i) {
            Rng rng(seed, static_cast<std::uint64_t>(1000 + cluster * spheres_per_cluster + i));
            // Radii from 5 m to 5 cm; every sphere has as many triangles.
            const double scale = static_cast<double>(i) / (spheres_per_cluster - 1);
            const double radius = 5 / (1 + 99 * scale * scale);
            const double distance = 3 + 9 * (1 - scale);
            Vec3d offset;
            do
                offset = {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
            while (dot(offset, offset) > 1 || dot(offset, offset) < 0.25);
            mesh.add_sphere(
                center + offset * distance, radius, scene_detail::scaled(12, std::sqrt(detail), 2)
            );
        }
    }
    mesh.end_group();
}

} // namespace

Scene generate_spheres(const GenerateParams& params) {
    const auto build = [&](MeshBuilder& mesh, double detail) {
        add_clusters(mesh, detail, params.seed);
    };
    Scene scene;
    scene.name = "spheres";
    const double detail = scene_detail::fit_detail(params.triangles, build);
    MeshBuilder mesh(scene);
    build(mesh, detail);

    Light lamp;
    lamp.name = "lamp";
    lamp.kind = LightKind::point;
    lamp.position = cluster_center(0, params.seed);
    lamp.range = 40;
    scene.lights = {lamp};

    Camera camera;
    camera.name = "view";
    camera.eye = {50, 80, 330};
    camera.frame = frame_along({0, 0, -1});
    camera.near = 1;
    camera.far = 1000;
    scene.cameras = {camera};
    return scene;
}

} // namespace raywise
