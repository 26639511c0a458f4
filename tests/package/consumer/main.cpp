// A stranger's program: a mesh of the caller's own, a sun, two rays whose answers are known, a
// heuristic that is a lambda.
#include <raywise/raywise.hpp>

#include <array>
#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
    using namespace raywise;
    const std::vector<Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}};
    const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 2, 1}, {1, 2, 3}};
    const TriangleView mesh(vertices, triangles);

    const Aabb around{{-1, -1, -1}, {2, 2, 2}};
    const auto sun =
        InfluenceArea::parallel("sun", {.direction = {0, -1, 0}, .region = obb_around(around)});
    const Accelerator accel = build_accelerator(mesh, {sun});
    const auto hit = accel.closest_hit({.origin = {0.75F, 1, 0.75F}, .direction = {0, -2, 0}});
    const bool missed = !accel.any_hit({.origin = {1.5F, 1, 0.5F}, .direction = {0, -1, 0}});

    const std::array<Aabb, 2> boxes{bounds(mesh[PrimId{0}]), bounds(mesh[PrimId{1}])};
    const Bvh tree = build_binned(boxes, [](const Aabb& box) { return half_area(box); });

    const bool right =
        hit && hit->prim == PrimId{1} && hit->t == 0.5F && missed && tree.prims.size() == 2;
    std::puts(right ? "raywise answers" : "wrong answer");
    return right ? 0 : 1;
}
