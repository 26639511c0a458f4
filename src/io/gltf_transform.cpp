#include "gltf_transform.hpp"
#include "io/json_reader.hpp"

#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace raywise::io_detail {

namespace {

template <std::size_t Count>
std::array<double, Count> numbers(const JsonValue& value) {
    std::array<double, Count> result{};
    if (value.size() != Count) value.refuse("must have " + std::to_string(Count) + " numbers");
    for (std::size_t i = 0; i < Count; ++i)
        result[i] = value[i].number();
    return result;
}

double positive(const JsonValue& value) {
    const double number = value.number();
    if (!(number > 0)) value.refuse("must be positive");
    return number;
}

/// Full angle of a field of view whose half has this tangent.
double full_angle(double tangent) {
    return 2 * std::atan(tangent);
}

} // namespace

std::optional<GltfTransform> transform_of(const GltfPose& pose) {
    auto [x, y, z, w] = pose.rotation;
    const double norm = std::sqrt(x * x + y * y + z * z + w * w);
    if (!(std::abs(norm - 1) < 0.01)) return std::nullopt;
    if (norm != 1)
        for (double* part : {&x, &y, &z, &w})
            *part /= norm;
    GltfTransform transform;
    transform.axes[0] =
        Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)} * pose.scale.x;
    transform.axes[1] =
        Vec3d{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)} * pose.scale.y;
    transform.axes[2] =
        Vec3d{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)} * pose.scale.z;
    transform.origin = pose.translation;
    return transform;
}

GltfTransform read_gltf_transform(const JsonValue& node) {
    const auto translation = node.find("translation");
    const auto rotation = node.find("rotation");
    const auto scale = node.find("scale");
    if (const auto matrix = node.find("matrix")) {
        if (translation || rotation || scale)
            node.refuse("has a matrix beside translation, rotation or scale");
        const auto m = numbers<16>(*matrix);
        if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
            matrix->refuse("is not affine: its last row must be 0, 0, 0, 1");
        return {
            {Vec3d{m[0], m[1], m[2]}, Vec3d{m[4], m[5], m[6]}, Vec3d{m[8], m[9], m[10]}},
            {m[12], m[13], m[14]}
        };
    }
    GltfPose pose;
    if (translation) {
        const auto t = numbers<3>(*translation);
        pose.translation = {t[0], t[1], t[2]};
    }
    if (rotation) pose.rotation = numbers<4>(*rotation);
    if (scale) {
        const auto s = numbers<3>(*scale);
        pose.scale = {s[0], s[1], s[2]};
    }
    const auto transform = transform_of(pose);
    if (!transform) rotation->refuse("is not a unit quaternion");
    return *transform;
}

Camera read_camera(const JsonValue& camera, const GltfTransform& transform, std::string name) {
    Camera result;
    result.name = std::move(name);
    result.eye = transform.origin;
    const Vec3d forward = -transform.axes[2];
    const Vec3d right = cross(transform.axes[1], forward);
    if (!(length(forward) > 0 && length(right) > 0 && std::isfinite(length(right))))
        camera.refuse("stands in a node whose transform is singular");
    result.frame.forward = normalized(forward);
    result.frame.right = normalized(right);
    result.frame.up = cross(result.frame.forward, result.frame.right);
    const JsonValue type = camera.at("type");
    if (type.string() == "perspective") {
        const JsonValue lens = camera.at("perspective");
        const JsonValue angle = lens.at("yfov");
        result.fov_y_rad = positive(angle);
        if (!(result.fov_y_rad < std::numbers::pi)) angle.refuse("must be below pi");
        const auto aspect = lens.find("aspectRatio");
        result.fov_x_rad =
            full_angle((aspect ? positive(*aspect) : 1) * std::tan(result.fov_y_rad / 2));
        result.near = positive(lens.at("znear"));
        if (const auto far = lens.find("zfar")) result.far = positive(*far);
    } else if (type.string() == "orthographic") {
        const JsonValue lens = camera.at("orthographic");
        result.projection = Projection::orthographic;
        result.half_width = positive(lens.at("xmag"));
        result.half_height = positive(lens.at("ymag"));
        result.near = lens.at("znear").number();
        result.far = positive(lens.at("zfar"));
    } else {
        type.refuse("must be perspective or orthographic");
    }
    if (!(result.near >= 0 && result.near < result.far))
        camera.refuse("has a znear that is not in [0, zfar)");
    if (!(result.fov_x_rad > 0 && result.fov_x_rad < std::numbers::pi))
        camera.refuse("has an aspectRatio out of range");
    return result;
}

Light read_light(const JsonValue& light, const GltfTransform& transform, std::string name) {
    Light result;
    result.name = std::move(name);
    if (result.name.empty())
        if (const auto own = light.find("name")) result.name = own->string();
    result.position = transform.origin;
    const JsonValue type = light.at("type");
    if (type.string() == "directional")
        result.kind = LightKind::directional;
    else if (type.string() == "point")
        result.kind = LightKind::point;
    else if (type.string() == "spot")
        result.kind = LightKind::spot;
    else
        type.refuse("must be directional, point or spot");
    if (result.kind != LightKind::point) {
        if (!(length(transform.axes[2]) > 0)) light.refuse("stands in a node without direction");
        result.direction = normalized(-transform.axes[2]);
    }
    if (const auto range = light.find("range")) result.range = positive(*range);
    if (result.kind == LightKind::spot) {
        const JsonValue spot = light.at("spot");
        const auto outer = spot.find("outerConeAngle");
        result.cone_rad = outer ? positive(*outer) : std::numbers::pi / 4;
        // Files round pi / 2 to single precision, up or down.
        if (outer && result.cone_rad > 1.5708) outer->refuse("must be at most pi / 2");
        result.cone_rad = std::min(result.cone_rad, std::numbers::pi / 2);
    }
    return result;
}

} // namespace raywise::io_detail
