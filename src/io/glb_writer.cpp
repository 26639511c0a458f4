// Writes GLB: one node and mesh for each run of triangles between group borders, so that order and
// names come back. After [Gltf21].
#include "byte_reader.hpp"
#include "scene_writer.hpp"

#include <raywise/core/error.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::io_detail {

namespace {

using nlohmann::json;

constexpr int array_buffer = 34962;
constexpr int index_buffer = 34963;

/// Appends the document's parts run by run.
class GlbWriter {
public:
    explicit GlbWriter(const Scene& scene)
        : scene_(scene), moved_(scene.vertices.size(), unmoved) {}

    std::string write() {
        std::size_t next = 0;
        for (const Group& group : scene_.groups) {
            add_run(next, group.first, {});
            next = std::size_t{group.first} + group.count;
            add_run(group.first, next, group.name);
        }
        add_run(next, scene_.triangles.size(), {});
        for (const Light& light : scene_.lights)
            add_light(light);
        for (const Camera& camera : scene_.cameras)
            add_camera(camera);
        finish_document();
        return container();
    }

private:
    static constexpr std::uint32_t unmoved = 0xFFFFFFFFU;

    /// Triangles [first, end) with the vertices they use.
    void add_run(std::size_t first, std::size_t end, const std::string& name) {
        if (first == end) return;
        std::vector<std::uint32_t> used;
        std::string indices;
        for (std::size_t i = first; i < end; ++i)
            for (const std::uint32_t corner : scene_.triangles[i]) {
                if (moved_[corner] == unmoved) {
                    moved_[corner] = static_cast<std::uint32_t>(used.size());
                    used.push_back(corner);
                }
                append(indices, moved_[corner]);
            }
        Aabb box;
        std::string positions;
        for (const std::uint32_t vertex : used) {
            const Vec3 v = scene_.vertices[vertex];
            box = unite(box, v);
            for (int axis = 0; axis < 3; ++axis)
                append(positions, v[axis]);
            moved_[vertex] = unmoved;
        }
        json accessor = add_accessor(positions, array_buffer, used.size(), "VEC3", 5126);
        accessor["min"] = {box.lo.x, box.lo.y, box.lo.z};
        accessor["max"] = {box.hi.x, box.hi.y, box.hi.z};
        accessors_.push_back(accessor);
        accessors_.push_back(add_accessor(indices, index_buffer, 3 * (end - first), "SCALAR", 5125)
        );
        json primitive{
            {"attributes", {{"POSITION", accessors_.size() - 2}}},
            {"indices", accessors_.size() - 1}
        };
        meshes_.push_back({{"primitives", json::array({primitive})}});
        json node{{"mesh", meshes_.size() - 1}};
        if (!name.empty()) node["name"] = name;
        nodes_.push_back(node);
    }

    json add_accessor(
        const std::string& bytes,
        int target,
        std::size_t count,
        std::string_view type,
        int component_type
    ) {
        views_.push_back(
            {{"buffer", 0},
             {"byteOffset", binary_.size()},
             {"byteLength", bytes.size()},
             {"target", target}}
        );
        binary_ += bytes;
        return {
            {"bufferView", views_.size() - 1},
            {"componentType", component_type},
            {"count", count},
            {"type", type}
        };
    }

    /// A node at a place, whose -z is the frame's forward axis and whose y is up.
    static json node_at(Vec3d place, const Frame& frame, const std::string& name) {
        const Vec3d x = -frame.right;
        const Vec3d y = frame.up;
        const Vec3d z = -frame.forward;
        json node{
            {"matrix",
             {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, place.x, place.y, place.z, 1}}
        };
        if (!name.empty()) node["name"] = name;
        return node;
    }

    void add_light(const Light& light) {
        json entry;
        if (light.kind == LightKind::directional) entry["type"] = "directional";
        if (light.kind == LightKind::point) entry["type"] = "point";
        if (light.kind == LightKind::spot) {
            entry["type"] = "spot";
            entry["spot"] = {{"outerConeAngle", light.cone_rad}};
        }
        if (std::isfinite(light.range) && light.kind != LightKind::directional)
            entry["range"] = light.range;
        lights_.push_back(entry);
        const Frame frame = light.kind == LightKind::point ? Frame{} : frame_along(light.direction);
        json node = node_at(
            light.kind == LightKind::directional ? Vec3d{} : light.position, frame, light.name
        );
        node["extensions"]["KHR_lights_punctual"]["light"] = lights_.size() - 1;
        nodes_.push_back(node);
    }

    void add_camera(const Camera& camera) {
        json entry;
        json lens;
        // The format has no perspective camera with near = 0, nor an orthographic one without far.
        constexpr double nearest = 1e-6;
        if (camera.projection == Projection::perspective) {
            lens["yfov"] = camera.fov_y_rad;
            lens["aspectRatio"] = std::tan(camera.fov_x_rad / 2) / std::tan(camera.fov_y_rad / 2);
            lens["znear"] = std::max(camera.near, nearest);
            if (std::isfinite(camera.far)) lens["zfar"] = camera.far;
            entry = {{"type", "perspective"}, {"perspective", lens}};
        } else {
            constexpr double farthest = 1e18;
            lens["xmag"] = camera.half_width;
            lens["ymag"] = camera.half_height;
            lens["znear"] = camera.near;
            lens["zfar"] = std::min(camera.far, std::max(farthest, 2 * camera.near));
            entry = {{"type", "orthographic"}, {"orthographic", lens}};
        }
        cameras_.push_back(entry);
        json node = node_at(camera.eye, camera.frame, camera.name);
        node["camera"] = cameras_.size() - 1;
        nodes_.push_back(node);
    }

    void finish_document() {
        document_["asset"] = {{"version", "2.0"}, {"generator", "raywise"}};
        document_["scene"] = 0;
        json root = json::array();
        for (std::size_t i = 0; i < nodes_.size(); ++i)
            root.push_back(i);
        document_["scenes"] = json::array({{{"nodes", root}}});
        document_["nodes"] = nodes_;
        document_["meshes"] = meshes_;
        document_["accessors"] = accessors_;
        document_["bufferViews"] = views_;
        document_["buffers"] = json::array({{{"byteLength", binary_.size()}}});
        if (!cameras_.empty()) document_["cameras"] = cameras_;
        if (!lights_.empty()) {
            document_["extensionsUsed"] = {"KHR_lights_punctual"};
            document_["extensions"]["KHR_lights_punctual"]["lights"] = lights_;
        }
    }

    std::string container() const {
        // Names may hold anything; bytes that are no UTF-8 become U+FFFD.
        std::string text = document_.dump(-1, ' ', false, json::error_handler_t::replace);
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const std::size_t size = 12 + 8 + text.size() + 8 + binary_.size();
        if (size > std::numeric_limits<std::uint32_t>::max())
            throw Error("a GLB file cannot exceed 4 GiB; PLY can");
        std::string bytes = "glTF";
        append(bytes, std::uint32_t{2});
        append(bytes, static_cast<std::uint32_t>(size));
        append(bytes, static_cast<std::uint32_t>(text.size()));
        bytes += "JSON" + text;
        append(bytes, static_cast<std::uint32_t>(binary_.size()));
        bytes += std::string("BIN\0", 4) + binary_;
        return bytes;
    }

    const Scene& scene_;
    std::vector<std::uint32_t> moved_; ///< of each vertex, its index in the current run
    json document_;
    json nodes_ = json::array();
    json meshes_ = json::array();
    json accessors_ = json::array();
    json views_ = json::array();
    json lights_ = json::array();
    json cameras_ = json::array();
    std::string binary_; ///< multiples of 4 bytes only, hence always aligned
};

} // namespace

std::string write_glb(const Scene& scene) {
    return GlbWriter(scene).write();
}

} // namespace raywise::io_detail
