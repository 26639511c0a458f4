// Appends simple shapes to a scene: what the generated scenes are assembled from.
#pragma once

#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace raywise::scene_detail {

/// Sine and cosine from +, -, * alone, so that generated scenes have the same bytes everywhere;
/// within 1e-15 for |turns| <= 2^20. The argument is in full turns.
[[nodiscard]] double sine_of_turns(double turns);
[[nodiscard]] double cosine_of_turns(double turns);

/// A point of a profile to be turned about the y axis: distance from the axis, and height.
struct ProfilePoint {
    double radius = 0;
    double height = 0;
};

/// Adds shapes to a scene, or only counts their triangles when there is none. Triangles are
/// counter-clockwise seen from outside, or from the side that the shape's comment names.
class MeshBuilder {
public:
    /// Counts only; vertex indices are meaningless.
    MeshBuilder() = default;

    explicit MeshBuilder(Scene& scene) : scene_(&scene) {}

    [[nodiscard]] std::size_t triangles() const { return triangles_; }

    /// Everything added between begin and the next begin (or end) is one group.
    void begin_group(std::string name);
    void end_group();

    std::uint32_t add_vertex(Vec3d position);
    void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);

    /// a, b, c, d counter-clockwise seen from the front.
    void add_quad(Vec3d a, Vec3d b, Vec3d c, Vec3d d);

    /// Cells of the patch point(u, v), u and v in [0, 1]; 2 columns rows triangles, whose front is
    /// along du x dv. Neighboring cells share vertices.
    void add_patch(int columns, int rows, const std::function<Vec3d(double u, double v)>& point);

    /// An axis-aligned box; its front is outside.
    void add_box(Vec3d lo, Vec3d hi);

    /// The profile, from bottom to top, turned about the vertical line through `foot`; the front is
    /// away from the axis. Points on the axis (radius 0) close the shape. segments >= 3.
    void add_lathe(Vec3d foot, std::span<const ProfilePoint> profile, int segments);

    /// A sphere of `rings` (>= 2) bands of latitude and 2 rings meridians: 4 rings (rings - 1)
    /// triangles.
    void add_sphere(Vec3d center, double radius, int rings);

private:
    Scene* scene_ = nullptr;
    std::size_t triangles_ = 0;
};

/// The detail (about proportional to the number of triangles) at which `build` adds at least
/// `triangles`, found by counting. Throws Error unless triangles is in [100, 100'000'000].
[[nodiscard]] double
fit_detail(std::size_t triangles, const std::function<void(MeshBuilder&, double)>& build);

/// base * detail, rounded, at least `least`: a count that grows with the detail.
[[nodiscard]] int scaled(double base, double detail, int least);

} // namespace raywise::scene_detail
