// The data of a glTF document: buffers, buffer views and accessors, every count and offset checked
// against the bytes that are there. After [Gltf21].
#pragma once

#include "json_reader.hpp"
#include "scene_reader.hpp"

#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::io_detail {

/// The component types, by their numbers in the format.
enum class GltfType : std::uint16_t {
    i8 = 5120,
    u8 = 5121,
    i16 = 5122,
    u16 = 5123,
    u32 = 5125,
    f32 = 5126,
};

/// Elements that stand `stride` bytes apart.
struct GltfElements {
    std::string_view bytes; ///< from the first element; empty: all zeros
    std::size_t stride = 0;
    GltfType type = GltfType::f32;
    bool is_normalized = false;
};

/// A checked accessor: all of its elements lie within `base`.
struct GltfAccessor {
    std::uint64_t count = 0; ///< > 0
    int components = 0;      ///< 1 (SCALAR) to 4 (VEC4)
    GltfElements base;
    std::vector<std::uint32_t> sparse_indices; ///< ascending, < count
    GltfElements sparse_values;

    /// A component as a number; normalized integers are in [-1, 1]. index < count.
    [[nodiscard]] double component(std::uint64_t index, int which) const;
};

/// The buffers and accessors of one document.
class GltfData {
public:
    /// `chunk`: the binary chunk of a GLB file, which is buffer 0 then. All must outlive this.
    GltfData(SceneReader& reader, const JsonValue& document, std::optional<std::string_view> chunk)
        : reader_(reader), document_(document), chunk_(chunk) {}

    /// The accessor with this number, which must have one of the component counts.
    [[nodiscard]] GltfAccessor accessor(const JsonValue& index, int components);

private:
    [[nodiscard]] std::string_view buffer(const JsonValue& index);
    [[nodiscard]] std::string_view view(const JsonValue& index, std::size_t* stride);
    [[nodiscard]] GltfElements elements(
        const JsonValue& holder,
        GltfType type,
        int components,
        bool is_normalized,
        std::uint64_t count
    );
    void read_sparse(const JsonValue& sparse, GltfAccessor& accessor);

    SceneReader& reader_;
    const JsonValue& document_;
    std::optional<std::string_view> chunk_;
    std::map<std::uint64_t, std::string> buffers_;          ///< those with a data URI, decoded
    std::map<std::string, std::string, std::less<>> files_; ///< those beside the document
};

/// The bytes of base64 text; nullopt when it is malformed. [RFC4648]
[[nodiscard]] std::optional<std::string> decode_base64(std::string_view text);

/// A URI's path with %XX replaced; nullopt when it is malformed. [RFC3986]
[[nodiscard]] std::optional<std::string> decode_percent(std::string_view text);

} // namespace raywise::io_detail
