// Reads glTF 2.0 and GLB: the default scene's nodes, their meshes expanded into one, with cameras,
// lights and instances. Our own reader on a JSON parser: every index, offset and count is checked
// before it is used, and nodes are walked without recursion. After [Gltf21].
#include "byte_reader.hpp"
#include "gltf_data.hpp"
#include "gltf_transform.hpp"
#include "json_reader.hpp"
#include "scene_reader.hpp"

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raywise::io_detail {

namespace {

constexpr std::uint64_t max_index = 0x7FFFFFFF;

/// Extensions that leave triangles as they are, or are read here.
bool is_supported(std::string_view extension) {
    for (const std::string_view known :
         {"KHR_lights_punctual",
          "EXT_mesh_gpu_instancing",
          "KHR_mesh_quantization",
          "KHR_texture_transform",
          "KHR_texture_basisu",
          "EXT_texture_webp",
          "KHR_animation_pointer"})
        if (extension == known) return true;
    return extension.starts_with("KHR_materials_");
}

enum class Topology : std::uint8_t { triangles = 4, strip = 5, fan = 6 };

struct Primitive {
    std::uint64_t positions_index = 0; ///< of the accessor, to know shared ones
    GltfAccessor positions;
    std::optional<GltfAccessor> indices;
    Topology topology = Topology::triangles;

    [[nodiscard]] std::uint64_t corner_count() const {
        return indices ? indices->count : positions.count;
    }

    [[nodiscard]] std::uint64_t triangle_count() const {
        return topology == Topology::triangles ? corner_count() / 3 : corner_count() - 2;
    }
};

/// A mesh that stands somewhere in the scene.
struct Placement {
    std::size_t mesh = 0;
    GltfTransform transform;
    std::string name;
};

class GltfReader {
public:
    GltfReader(
        SceneReader& reader,
        const JsonValue& document,
        std::optional<std::string_view> chunk
    )
        : reader_(reader), document_(document), data_(reader, document, chunk) {}

    void read() {
        check_asset();
        place_nodes();
        count_and_reserve();
        for (const Placement& placement : placements_)
            expand(placement);
    }

private:
    [[nodiscard]] std::optional<JsonValue> items(std::string_view name) const {
        return document_.find(name);
    }

    [[nodiscard]] std::size_t count(std::string_view name) const {
        const auto found = items(name);
        return found ? found->size() : 0;
    }

    /// The item of a top-level array that an index names.
    [[nodiscard]] std::size_t index_into(std::string_view name, const JsonValue& index) const {
        const std::uint64_t which = index.integer(max_index);
        const std::size_t size = count(name);
        if (which >= size) index.refuse(fmt::format("refers to {}[{}] of {}", name, which, size));
        return static_cast<std::size_t>(which);
    }

    void check_asset() const {
        if (!document_.is_object()) document_.refuse("must be an object");
        const JsonValue asset = document_.at("asset");
        const JsonValue version = asset.at("version");
        if (!version.string().starts_with("2.")) version.refuse("must be 2.x");
        if (const auto least = asset.find("minVersion"); least && least->string() != "2.0")
            least->refuse("is above 2.0");
        if (const auto required = items("extensionsRequired"))
            for (std::size_t i = 0; i < required->size(); ++i) {
                const std::string& name = (*required)[i].string();
                if (!is_supported(name))
                    (*required)[i].refuse(
                        fmt::format("the required extension {} is not supported", escaped(name, 60))
                    );
            }
    }

    /// The nodes to start from: those of the default scene, or every node without a parent.
    [[nodiscard]] std::vector<std::size_t> roots() const {
        std::vector<std::size_t> result;
        if (count("scenes") != 0) {
            const auto chosen = document_.find("scene");
            const std::size_t which = chosen ? index_into("scenes", *chosen) : 0;
            const JsonValue scene = (*items("scenes"))[which];
            if (const auto nodes = scene.find("nodes"))
                for (std::size_t i = 0; i < nodes->size(); ++i)
                    result.push_back(index_into("nodes", (*nodes)[i]));
            return result;
        }
        std::vector<bool> has_parent(count("nodes"));
        const auto nodes = items("nodes");
        for (std::size_t i = 0; i < has_parent.size(); ++i)
            if (const auto children = (*nodes)[i].find("children"))
                for (std::size_t k = 0; k < children->size(); ++k)
                    has_parent[index_into("nodes", (*children)[k])] = true;
        for (std::size_t i = 0; i < has_parent.size(); ++i)
            if (!has_parent[i]) result.push_back(i);
        return result;
    }

    /// Walks the nodes in the order of the document, parents first.
    void place_nodes() {
        struct Pending {
            std::size_t node;
            GltfTransform parent;
        };
        std::vector<Pending> pending;
        std::vector<bool> is_reached(count("nodes"));
        const std::vector<std::size_t> first = roots();
        for (std::size_t i = first.size(); i-- > 0;)
            pending.push_back({first[i], {}});
        while (!pending.empty()) {
            const Pending next = pending.back();
            pending.pop_back();
            const JsonValue node = (*items("nodes"))[next.node];
            // Nodes form trees; this also ends every cycle.
            if (is_reached[next.node]) node.refuse("is reached twice: nodes must form trees");
            is_reached[next.node] = true;
            const GltfTransform transform = next.parent * read_gltf_transform(node);
            place(node, transform);
            if (const auto children = node.find("children"))
                for (std::size_t k = children->size(); k-- > 0;)
                    pending.push_back({index_into("nodes", (*children)[k]), transform});
        }
    }

    void place(const JsonValue& node, const GltfTransform& transform) {
        if (!transform.is_finite()) node.refuse("has a transform that is not finite");
        if (node.find("skin")) node.refuse("has a skin, which is not supported");
        check_weights(node);
        if (const auto mesh = node.find("mesh")) place_mesh(node, *mesh, transform);
        if (const auto camera = node.find("camera"))
            reader_.scene().cameras.push_back(read_camera(
                (*items("cameras"))[index_into("cameras", *camera)], transform, name_of(node)
            ));
        const auto extensions = node.find("extensions");
        if (!extensions) return;
        if (const auto light = extensions->find("KHR_lights_punctual"))
            place_light(light->at("light"), transform, name_of(node));
    }

    static std::string name_of(const JsonValue& holder) {
        const auto name = holder.find("name");
        return name ? name->string() : std::string();
    }

    static void check_weights(const JsonValue& holder) {
        if (const auto weights = holder.find("weights"))
            for (std::size_t i = 0; i < weights->size(); ++i)
                if ((*weights)[i].number() != 0)
                    weights->refuse("are not zero; morph targets are not supported");
    }

    void place_mesh(const JsonValue& node, const JsonValue& mesh, const GltfTransform& transform) {
        const std::size_t which = index_into("meshes", mesh);
        std::string name = name_of(node);
        if (name.empty()) name = name_of((*items("meshes"))[which]);
        const auto extensions = node.find("extensions");
        const auto instancing =
            extensions ? extensions->find("EXT_mesh_gpu_instancing") : std::nullopt;
        if (!instancing) {
            add_placement({which, transform, std::move(name)});
            return;
        }
        const JsonValue attributes = instancing->at("attributes");
        const auto translation = attribute(attributes, "TRANSLATION", 3);
        const auto rotation = attribute(attributes, "ROTATION", 4);
        const auto scale = attribute(attributes, "SCALE", 3);
        std::uint64_t instances = 0;
        for (const auto* accessor : {&translation, &rotation, &scale}) {
            if (!*accessor) continue;
            if (instances != 0 && instances != (*accessor)->count)
                attributes.refuse("differ in their counts");
            instances = (*accessor)->count;
        }
        for (std::uint64_t i = 0; i < instances; ++i) {
            GltfPose pose;
            for (int k = 0; k < 4; ++k) {
                const auto axis = static_cast<std::size_t>(k);
                if (k < 3 && translation) pose.translation[k] = translation->component(i, k);
                if (k < 3 && scale) pose.scale[k] = scale->component(i, k);
                if (rotation) pose.rotation[axis] = rotation->component(i, k);
            }
            const auto placed = transform_of(pose);
            if (!placed || !(transform * *placed).is_finite())
                attributes.refuse(fmt::format("instance {} has no valid transform", i));
            add_placement({which, transform * *placed, name});
        }
    }

    std::optional<GltfAccessor>
    attribute(const JsonValue& attributes, std::string_view name, int components) {
        const auto index = attributes.find(name);
        if (!index) return std::nullopt;
        return data_.accessor(*index, components);
    }

    void add_placement(Placement placement) {
        // Twice: a vector that grows keeps the old and the new.
        reader_.claim(2, sizeof(Placement) + placement.name.size());
        placements_.push_back(std::move(placement));
    }

    void place_light(const JsonValue& index, const GltfTransform& transform, std::string name) {
        const JsonValue holder = document_.at("extensions").at("KHR_lights_punctual").at("lights");
        const std::uint64_t which = index.integer(max_index);
        if (which >= holder.size())
            index.refuse(fmt::format("refers to light {} of {}", which, holder.size()));
        reader_.scene().lights.push_back(
            read_light(holder[static_cast<std::size_t>(which)], transform, std::move(name))
        );
    }

    const std::vector<Primitive>& primitives_of(std::size_t mesh) {
        const auto known = meshes_.find(mesh);
        if (known != meshes_.end()) return known->second;
        const JsonValue holder = (*items("meshes"))[mesh];
        check_weights(holder);
        const JsonValue list = holder.at("primitives");
        std::vector<Primitive> primitives;
        for (std::size_t i = 0; i < list.size(); ++i)
            if (auto primitive = read_primitive(list[i]))
                primitives.push_back(*std::move(primitive));
        return meshes_.emplace(mesh, std::move(primitives)).first->second;
    }

    /// nullopt for points, lines, and what has no positions to draw.
    std::optional<Primitive> read_primitive(const JsonValue& holder) {
        const auto extensions = holder.find("extensions");
        if (extensions && extensions->find("KHR_draco_mesh_compression"))
            holder.refuse("KHR_draco_mesh_compression is not supported");
        const auto mode = holder.find("mode");
        const std::uint64_t topology = mode ? mode->integer(6) : 4;
        const auto positions = holder.at("attributes").find("POSITION");
        if (topology < 4 || !positions) {
            ++reader_.report().ignored;
            return std::nullopt;
        }
        Primitive primitive;
        primitive.topology = static_cast<Topology>(topology);
        primitive.positions_index = positions->integer(max_index);
        primitive.positions = data_.accessor(*positions, 3);
        if (primitive.positions.base.type == GltfType::u32)
            positions->refuse("positions cannot be of 32-bit integers");
        if (const auto indices = holder.find("indices")) {
            primitive.indices = data_.accessor(*indices, 1);
            const GltfType type = primitive.indices->base.type;
            if (type != GltfType::u8 && type != GltfType::u16 && type != GltfType::u32)
                indices->refuse("must be unsigned integers");
        }
        const std::uint64_t corners = primitive.corner_count();
        if (corners < 3 || (primitive.topology == Topology::triangles && corners % 3 != 0))
            holder.refuse(fmt::format("{} corners make no whole triangles", corners));
        return primitive;
    }

    /// Counts what the placements expand to before anything is allocated for it.
    void count_and_reserve() {
        std::uint64_t vertices = 0;
        std::uint64_t triangles = 0;
        for (const Placement& placement : placements_) {
            std::vector<std::uint64_t> seen;
            for (const Primitive& primitive : primitives_of(placement.mesh)) {
                triangles += primitive.triangle_count();
                if (std::find(seen.begin(), seen.end(), primitive.positions_index) == seen.end()) {
                    vertices += primitive.positions.count;
                    seen.push_back(primitive.positions_index);
                }
            }
            if (vertices > max_triangles || triangles > max_triangles) break;
        }
        reader_.reserve(vertices, triangles);
    }

    /// Appends a mesh in its place. Primitives that share positions share vertices.
    void expand(const Placement& placement) {
        std::map<std::uint64_t, std::uint32_t> first_vertex;
        const std::size_t first_triangle = reader_.scene().triangles.size();
        for (const Primitive& primitive : primitives_of(placement.mesh)) {
            const auto [known, is_new] = first_vertex.try_emplace(
                primitive.positions_index,
                static_cast<std::uint32_t>(reader_.scene().vertices.size())
            );
            if (is_new) add_vertices(primitive.positions, placement.transform);
            add_triangles(primitive, known->second, placement.transform.is_mirrored());
        }
        const std::size_t count = reader_.scene().triangles.size() - first_triangle;
        if (count == 0 || placement.name.empty()) return;
        reader_.scene().groups.push_back(
            {placement.name,
             static_cast<std::uint32_t>(first_triangle),
             static_cast<std::uint32_t>(count)}
        );
    }

    void add_vertices(const GltfAccessor& positions, const GltfTransform& transform) {
        for (std::uint64_t i = 0; i < positions.count; ++i) {
            const Vec3d point{
                positions.component(i, 0), positions.component(i, 1), positions.component(i, 2)
            };
            const Vec3d placed = transform.point(point);
            reader_.add_vertex(
                {narrowed(placed.x), narrowed(placed.y), narrowed(placed.z)}, nowhere()
            );
        }
    }

    void add_triangles(const Primitive& primitive, std::uint32_t first, bool is_mirrored) {
        const auto corner = [&](std::uint64_t i) -> std::uint32_t {
            if (!primitive.indices) return first + static_cast<std::uint32_t>(i);
            const double index = primitive.indices->component(i, 0);
            if (!(index < static_cast<double>(primitive.positions.count)))
                reader_.refuse(
                    nowhere(),
                    fmt::format(
                        "index {} refers to vertex {} of {}", i, index, primitive.positions.count
                    )
                );
            return first + static_cast<std::uint32_t>(index);
        };
        for (std::uint64_t i = 0; i < primitive.triangle_count(); ++i) {
            std::array<std::uint32_t, 3> corners{};
            if (primitive.topology == Topology::triangles)
                corners = {corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)};
            else if (primitive.topology == Topology::fan)
                corners = {corner(i + 1), corner(i + 2), corner(0)};
            else // every other triangle of a strip turns the other way
                corners = {corner(i), corner(i + 1 + i % 2), corner(i + 2 - i % 2)};
            if (is_mirrored) std::swap(corners[1], corners[2]);
            reader_.add_face(corners, nowhere());
        }
    }

    SceneReader& reader_;
    const JsonValue& document_;
    GltfData data_;
    std::map<std::size_t, std::vector<Primitive>> meshes_;
    std::vector<Placement> placements_;
};

void read_document(
    SceneReader& reader,
    std::string_view text,
    std::optional<std::string_view> chunk
) {
    // Bytes that the document takes for each mark between its values, about.
    reader.claim(count_json_tokens(text), 48);
    const nlohmann::json document = parse_json(text, reader.path());
    const JsonValue root(document, reader.path());
    GltfReader(reader, root, chunk).read();
}

} // namespace

void read_gltf(SceneReader& reader) {
    read_document(reader, reader.bytes(), std::nullopt);
}

void read_glb(SceneReader& reader) {
    const std::string_view bytes = reader.bytes();
    constexpr std::uint32_t json_type = 0x4E4F534A;
    constexpr std::uint32_t binary_type = 0x004E4942;
    if (bytes.size() < 12 || !bytes.starts_with("glTF"))
        reader.refuse(at_byte(0), "not a GLB file");
    if (load<std::uint32_t>(bytes, 4) != 2) reader.refuse(at_byte(4), "the version must be 2");
    if (load<std::uint32_t>(bytes, 8) != bytes.size())
        reader.refuse(
            at_byte(8),
            fmt::format("says {} bytes, but has {}", load<std::uint32_t>(bytes, 8), bytes.size())
        );
    std::optional<std::string_view> text;
    std::optional<std::string_view> chunk;
    for (std::size_t at = 12; at < bytes.size();) {
        if (bytes.size() - at < 8) reader.refuse(at_byte(at), "a chunk ends too early");
        const std::size_t size = load<std::uint32_t>(bytes, at);
        const auto type = load<std::uint32_t>(bytes, at + 4);
        if (size % 4 != 0 || size > bytes.size() - at - 8)
            reader.refuse(
                at_byte(at), fmt::format("a chunk of {} bytes ends beyond the file", size)
            );
        const std::string_view content = bytes.substr(at + 8, size);
        if (at == 12 && type != json_type)
            reader.refuse(at_byte(at), "the first chunk must be JSON");
        if (at != 12 && type == json_type) reader.refuse(at_byte(at), "a second JSON chunk");
        if (type == binary_type && chunk) reader.refuse(at_byte(at), "a second binary chunk");
        if (type == json_type) text = content;
        if (type == binary_type) chunk = content;
        at += 8 + size;
    }
    if (!text) reader.refuse(at_byte(12), "it has no JSON chunk");
    read_document(reader, *text, chunk);
}

} // namespace raywise::io_detail
