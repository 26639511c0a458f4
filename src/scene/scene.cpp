// Questions about scenes. The degeneracy test is a filter followed by exact expansions, after
// [Shewchuk97].
#include <raywise/scene/scene.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/hash.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/rounding.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raywise {

namespace {

/// Whether the exact sum of the terms is zero. Each term is added to an expansion: numbers of which
/// no two share a bit, so that their sum is zero only when all are.
bool sums_to_zero(const std::array<double, 6>& terms) {
    std::array<double, 6> expansion{};
    std::size_t size = 0;
    for (const double term : terms) {
        double carry = term;
        for (std::size_t i = 0; i < size; ++i) {
            // Two-sum: carry + rest is exactly the sum of the operands.
            const double sum = carry + expansion[i];
            const double other = sum - carry;
            expansion[i] = (carry - (sum - other)) + (expansion[i] - other);
            carry = sum;
        }
        expansion[size++] = carry;
    }
    return std::all_of(expansion.begin(), expansion.end(), [](double part) { return part == 0; });
}

/// Whether a, b, c are on one line after the projection onto the (x, y) plane.
bool is_collinear(Vec2d a, Vec2d b, Vec2d c) {
    // (b - a) x (c - a), multiplied out: a product of two floats is exact in double.
    const std::array<double, 6> terms{
        b.x * c.y, -(b.x * a.y), -(a.x * c.y), -(b.y * c.x), b.y * a.x, a.y * c.x
    };
    double sum = 0;
    double magnitude = 0;
    for (const double term : terms) {
        sum += term;
        magnitude += std::abs(term);
    }
    if (std::abs(sum) > gamma_bound(12, double_epsilon) * magnitude) return false;
    return sums_to_zero(terms);
}

/// The one place that words the refusals of `validate`.
[[noreturn]] void refuse(std::string_view what, std::size_t index, std::string_view reason) {
    throw Error(std::string(what) + " " + std::to_string(index) + " " + std::string(reason));
}

bool is_storable(Vec3 point) {
    const Vec3 m = abs(point);
    return m.x <= max_coordinate && m.y <= max_coordinate && m.z <= max_coordinate;
}

bool is_direction(Vec3d direction) {
    return is_finite(direction) && direction != Vec3d{};
}

void validate_light(const Light& light, std::size_t index) {
    if (light.kind != LightKind::directional && !is_finite(light.position))
        refuse("light", index, "has a position that is not finite");
    if (light.kind != LightKind::point && !is_direction(light.direction))
        refuse("light", index, "has no direction");
    if (!(light.range > 0)) refuse("light", index, "has a range that is not positive");
    if (light.kind == LightKind::spot &&
        !(light.cone_rad > 0 && light.cone_rad <= std::numbers::pi / 2))
        refuse("light", index, "has a cone that is not in (0, pi / 2]");
}

void validate_camera(const Camera& camera, std::size_t index) {
    if (!is_finite(camera.eye)) refuse("camera", index, "has an eye that is not finite");
    if (!is_direction(camera.frame.forward) || !is_direction(camera.frame.right) ||
        !is_direction(camera.frame.up))
        refuse("camera", index, "has a frame that is not finite");
    const auto is_angle = [](double angle) { return angle > 0 && angle < std::numbers::pi; };
    if (camera.projection == Projection::perspective &&
        !(is_angle(camera.fov_x_rad) && is_angle(camera.fov_y_rad)))
        refuse("camera", index, "has a field of view that is not in (0, pi)");
    const auto is_size = [](double size) { return size > 0 && std::isfinite(size); };
    if (camera.projection == Projection::orthographic &&
        !(is_size(camera.half_width) && is_size(camera.half_height)))
        refuse("camera", index, "has a size that is not positive");
    if (!(camera.near >= 0 && camera.near < camera.far))
        refuse("camera", index, "has a near distance that is not in [0, far)");
}

void validate_groups(const Scene& scene) {
    std::size_t end = 0;
    for (std::size_t i = 0; i < scene.groups.size(); ++i) {
        const Group& group = scene.groups[i];
        if (group.first < end) refuse("group", i, "overlaps the group before it");
        end = std::size_t{group.first} + group.count;
        if (end > scene.triangles.size()) refuse("group", i, "ends beyond the triangles");
    }
}

using SortedCorners = std::array<std::array<float, 3>, 3>;

SortedCorners sorted_corners(const Triangle& triangle) {
    // Adding +0 turns -0 into +0.
    const auto place = [](Vec3 corner) {
        return std::array{corner.x + 0.0F, corner.y + 0.0F, corner.z + 0.0F};
    };
    SortedCorners corners{place(triangle.v0), place(triangle.v1), place(triangle.v2)};
    std::sort(corners.begin(), corners.end());
    return corners;
}

} // namespace

Aabb bounds(const Scene& scene) {
    Aabb box;
    for (const auto& corners : scene.triangles)
        for (const std::uint32_t corner : corners)
            box = unite(box, scene.vertices[corner]);
    return box;
}

std::vector<Aabb> triangle_boxes(const Scene& scene) {
    const TriangleView view = scene.view();
    std::vector<Aabb> boxes(view.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
        boxes[i] = bounds(view[to_prim(i)]);
    return boxes;
}

std::uint64_t content_hash(const Scene& scene) {
    // Blocks chain through the seed, so that no copy of the whole scene is needed.
    constexpr std::size_t block = 4096;
    std::vector<float> positions;
    positions.reserve(block * 9);
    std::uint64_t hash = scene.triangles.size();
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
        for (const std::uint32_t corner : scene.triangles[i]) {
            const Vec3 v = scene.vertices[corner];
            positions.insert(positions.end(), {v.x + 0.0F, v.y + 0.0F, v.z + 0.0F});
        }
        if (positions.size() == block * 9 || i + 1 == scene.triangles.size()) {
            hash = hash_elements(std::span<const float>(positions), hash);
            positions.clear();
        }
    }
    return hash;
}

bool is_degenerate(const Triangle& triangle) {
    const Vec3d a = to_double(triangle.v0);
    const Vec3d b = to_double(triangle.v1);
    const Vec3d c = to_double(triangle.v2);
    return is_collinear({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) &&
           is_collinear({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) &&
           is_collinear({a.z, a.x}, {b.z, b.x}, {c.z, c.x});
}

std::size_t count_degenerate(const Scene& scene) {
    const TriangleView view = scene.view();
    std::size_t count = 0;
    for (std::size_t i = 0; i < view.size(); ++i)
        if (is_degenerate(view[to_prim(i)])) ++count;
    return count;
}

std::size_t count_duplicates(const Scene& scene) {
    const TriangleView view = scene.view();
    std::vector<SortedCorners> all(view.size());
    for (std::size_t i = 0; i < view.size(); ++i)
        all[i] = sorted_corners(view[to_prim(i)]);
    std::sort(all.begin(), all.end());
    const auto first_copy = std::unique(all.begin(), all.end());
    return static_cast<std::size_t>(all.end() - first_copy);
}

void validate(const Scene& scene) {
    if (scene.vertices.size() > max_triangles)
        throw Error(ErrorKind::limit, scene.name, nowhere(), "more than 2,147,483,647 vertices");
    if (scene.triangles.size() > max_triangles)
        throw Error(ErrorKind::limit, scene.name, nowhere(), "more than 2,147,483,647 triangles");
    for (std::size_t i = 0; i < scene.vertices.size(); ++i)
        if (!is_storable(scene.vertices[i]))
            refuse("vertex", i, "has a coordinate that is not finite or beyond 2^60");
    for (std::size_t i = 0; i < scene.triangles.size(); ++i)
        for (const std::uint32_t corner : scene.triangles[i])
            if (corner >= scene.vertices.size())
                refuse(
                    "triangle",
                    i,
                    "refers to vertex " + std::to_string(corner) + " of " +
                        std::to_string(scene.vertices.size())
                );
    validate_groups(scene);
    for (std::size_t i = 0; i < scene.lights.size(); ++i)
        validate_light(scene.lights[i], i);
    for (std::size_t i = 0; i < scene.cameras.size(); ++i)
        validate_camera(scene.cameras[i], i);
}

} // namespace raywise
