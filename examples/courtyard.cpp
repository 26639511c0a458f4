// Builds an accelerator over a courtyard with a sun and a lamp, traces rays, and says who answered.
// The smallest whole program: no files, no command line.
#include <raywise/raywise.hpp>

#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <vector>

using namespace raywise;

namespace {

/// Points on the scene's triangles, as a renderer would shade them.
std::vector<Vec3> points_on(const Scene& scene, std::size_t count) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(1, i); // a stream per point: the same points whatever runs in parallel
        const Triangle t = scene.view()[to_prim(rng.below(scene.triangles.size()))];
        points.push_back((t.v0 + t.v1 + t.v2) * (1.0F / 3.0F));
    }
    return points;
}

} // namespace

int main() {
    const Scene scene = generate_courtyard({.triangles = 20'000});

    // An influence area is a region and the rays that are known to run in it.
    const Obb around = obb_around(bounds(scene));
    const auto sun =
        InfluenceArea::parallel("sun", {.direction = {0.3, -0.8, 0.5}, .region = around});
    const auto lamp = InfluenceArea::radial("lamp", {.apex = {0, 3, 0}, .region = around});

    // A structure of its own for each area that pays for one, a global tree for everything else.
    const Executor threads;
    const Accelerator accel = build_accelerator(scene, {sun, lamp}, {}, threads);

    // Any ray: its area is found, and the answer is that of one tree over everything.
    const Ray ray{.origin = {0, 5, 0}, .direction = {0.1F, -1, 0.05F}};
    Served served;
    if (const std::optional<Hit> hit = accel.closest_hit(ray, served)) {
        std::printf(
            "triangle %zu at t = %g, after %zu searches\n",
            to_index(hit->prim),
            static_cast<double>(hit->t),
            served.searches().size()
        );
    }

    // The caller knows the pencil: shadows toward the sun, a batch.
    const std::vector<Vec3> points = points_on(scene, 10'000);
    const auto shadowed = std::make_unique<bool[]>(points.size());
    accel["sun"].occluded(points, {shadowed.get(), points.size()}, 1e-3F, threads);
    std::size_t dark = 0;
    for (const bool is_dark : std::span(shadowed.get(), points.size()))
        dark += is_dark ? 1 : 0;
    std::printf("%zu of %zu points are in the sun's shadow\n", dark, points.size());

    // What it costs in memory, beside one plain tree.
    const AcceleratorMemory memory = accel.measure_memory();
    std::printf(
        "%zu KiB, of which the areas take %zu\n",
        memory.total() / 1024,
        (memory.total() - memory.global_tree) / 1024
    );
    return 0;
}
