// Scenes as plain values: one indexed triangle mesh with named groups, lights and cameras.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace raywise {

/// The most triangles, and the most vertices, that a scene may have.
inline constexpr std::size_t max_triangles = 0x7FFFFFFF;

/// The largest magnitude of a coordinate: products of three differences then stay finite in float.
inline constexpr float max_coordinate = 0x1p60F;

/// A named run of triangles, such as an object of a file.
struct Group {
    std::string name;
    std::uint32_t first = 0; ///< its first triangle
    std::uint32_t count = 0; ///< its triangles: [first, first + count)

    friend bool operator==(const Group&, const Group&) = default;
};

enum class LightKind : std::uint8_t { directional, point, spot };

/// Where light comes from; colors and powers play no part in tracing.
struct Light {
    std::string name;
    LightKind kind = LightKind::point;
    Vec3d position; ///< not used by a directional light
    Vec3d direction{
        0,
        0,
        -1
    }; ///< the way the light travels, any nonzero length; not used by a point light
    double range = std::numeric_limits<double>::infinity(); ///< reach in scene units, > 0
    double cone_rad = 0; ///< half angle of a spot's cone, in (0, pi / 2]; not used by the others

    friend bool operator==(const Light&, const Light&) = default;
};

enum class Projection : std::uint8_t { perspective, orthographic };

/// A view of the scene. The frame's forward axis looks into the picture.
struct Camera {
    std::string name;
    Projection projection = Projection::perspective;
    Vec3d eye;
    Frame frame;
    double fov_x_rad = 1;   ///< full horizontal field of view, in (0, pi); perspective only
    double fov_y_rad = 1;   ///< full vertical field of view, in (0, pi); perspective only
    double half_width = 1;  ///< > 0, scene units; orthographic only
    double half_height = 1; ///< > 0, scene units; orthographic only
    double near = 0;        ///< >= 0
    double far = std::numeric_limits<double>::infinity(); ///< > near
};

/// Triangles in scene order: the place of a triangle is its PrimId.
struct Scene {
    std::string name;
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles; ///< indices of vertices, counter-clockwise
    std::vector<Group> groups; ///< disjoint, ascending; triangles of no group are allowed
    std::vector<Light> lights;
    std::vector<Camera> cameras;

    /// Reads this scene in place; valid until its vectors change.
    [[nodiscard]] TriangleView view() const { return {vertices, triangles}; }
};

/// The box of the vertices that triangles use; empty for a scene without triangles.
[[nodiscard]] Aabb bounds(const Scene& scene);

/// The box of one triangle each, in scene order.
[[nodiscard]] std::vector<Aabb> triangle_boxes(const Scene& scene);

/// XXH3 of what rays can meet: the corner positions of the triangles, in scene order. Vertex order,
/// names, lights and cameras do not enter, -0 counts as 0.
[[nodiscard]] std::uint64_t content_hash(const Scene& scene);

/// Whether the vertices lie on one line or in one point, decided exactly. Coordinates finite and
/// within `max_coordinate`.
[[nodiscard]] bool is_degenerate(const Triangle& triangle);

/// The number of triangles of exactly zero area.
[[nodiscard]] std::size_t count_degenerate(const Scene& scene);

/// The number of triangles whose corners are those of an earlier one, in any order; -0 counts as 0.
/// Takes O(n log n) time and 36 bytes for each triangle.
[[nodiscard]] std::size_t count_duplicates(const Scene& scene);

/// Throws Error, naming the first offender, unless every coordinate is finite and within
/// `max_coordinate`, every index names a vertex, groups are ascending, disjoint and within the
/// triangles, the counts are within `max_triangles`, and lights and cameras keep to their ranges.
/// A scene without triangles is valid.
void validate(const Scene& scene);

} // namespace raywise
