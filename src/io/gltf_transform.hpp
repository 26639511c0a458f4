// Where glTF nodes stand: transforms, and the cameras and lights that are placed by them. After
// [Gltf21].
#pragma once

#include "json_reader.hpp"

#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <array>
#include <optional>
#include <string>

namespace raywise::io_detail {

/// An affine map: the images of the three axes, and of the origin.
struct GltfTransform {
    std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    Vec3d origin;

    friend bool operator==(const GltfTransform&, const GltfTransform&) = default;

    /// The identity keeps every bit, that of -0 included.
    [[nodiscard]] Vec3d point(Vec3d p) const {
        return *this == GltfTransform{} ? p : direction(p) + origin;
    }

    [[nodiscard]] Vec3d direction(Vec3d d) const {
        return axes[0] * d.x + axes[1] * d.y + axes[2] * d.z;
    }

    /// `inner` first.
    friend GltfTransform operator*(const GltfTransform& outer, const GltfTransform& inner) {
        if (outer == GltfTransform{}) return inner;
        return {
            {outer.direction(inner.axes[0]),
             outer.direction(inner.axes[1]),
             outer.direction(inner.axes[2])},
            outer.point(inner.origin)
        };
    }

    [[nodiscard]] bool is_finite() const {
        return raywise::is_finite(axes[0]) && raywise::is_finite(axes[1]) &&
               raywise::is_finite(axes[2]) && raywise::is_finite(origin);
    }

    /// Whether it turns triangles around.
    [[nodiscard]] bool is_mirrored() const { return dot(cross(axes[0], axes[1]), axes[2]) < 0; }
};

/// Scale, then rotation (a quaternion x, y, z, w), then translation.
struct GltfPose {
    Vec3d translation;
    std::array<double, 4> rotation{0, 0, 0, 1};
    Vec3d scale{1, 1, 1};
};

/// nullopt when the quaternion is not of unit length, within 1 %.
[[nodiscard]] std::optional<GltfTransform> transform_of(const GltfPose& pose);

/// A node's own transform: its matrix, or its translation, rotation and scale.
[[nodiscard]] GltfTransform read_gltf_transform(const JsonValue& node);

/// A camera of the document, looking along the node's -z.
[[nodiscard]] Camera
read_camera(const JsonValue& camera, const GltfTransform& transform, std::string name);

/// A light of KHR_lights_punctual, shining along the node's -z.
[[nodiscard]] Light
read_light(const JsonValue& light, const GltfTransform& transform, std::string name);

} // namespace raywise::io_detail
