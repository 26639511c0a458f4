#include "byte_reader.hpp"
#include "gltf_data.hpp"
#include "io/json_reader.hpp"

#include <raywise/io/files.hpp>
#include <raywise/scene/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace raywise::io_detail {

namespace {

constexpr std::uint64_t max_size = std::uint64_t{1} << 48U;

std::size_t size_of(GltfType type) {
    switch (type) {
    case GltfType::i8:
    case GltfType::u8:
        return 1;
    case GltfType::i16:
    case GltfType::u16:
        return 2;
    case GltfType::u32:
    case GltfType::f32:
        return 4;
    }
    return 0;
}

/// Signed components of n bits span [-(2^(n-1) - 1), 2^(n-1) - 1] when normalized.
double component_at(const GltfElements& elements, std::size_t at) {
    if (elements.bytes.empty()) return 0;
    const auto scaled = [&](double value, double largest) {
        return elements.is_normalized ? std::max(value / largest, -1.0) : value;
    };
    switch (elements.type) {
    case GltfType::i8:
        return scaled(load<std::int8_t>(elements.bytes, at), 127);
    case GltfType::u8:
        return scaled(load<std::uint8_t>(elements.bytes, at), 255);
    case GltfType::i16:
        return scaled(load<std::int16_t>(elements.bytes, at), 32767);
    case GltfType::u16:
        return scaled(load<std::uint16_t>(elements.bytes, at), 65535);
    case GltfType::u32:
        return load<std::uint32_t>(elements.bytes, at);
    case GltfType::f32:
        return static_cast<double>(load<float>(elements.bytes, at));
    }
    return 0;
}

GltfType component_type(const JsonValue& value) {
    const std::uint64_t number = value.integer(0xFFFF);
    for (const GltfType type :
         {GltfType::i8, GltfType::u8, GltfType::i16, GltfType::u16, GltfType::u32, GltfType::f32})
        if (number == static_cast<std::uint64_t>(type)) return type;
    value.refuse(fmt::format("{} is not a component type", number));
}

int component_count(const JsonValue& value) {
    constexpr std::array<std::string_view, 4> names{"SCALAR", "VEC2", "VEC3", "VEC4"};
    for (std::size_t i = 0; i < names.size(); ++i)
        if (value.string() == names[i]) return static_cast<int>(i) + 1;
    return 0; // matrices are valid, but nothing here asks for them
}

std::uint64_t integer_or(const JsonValue& holder, std::string_view key, std::uint64_t absent) {
    const auto value = holder.find(key);
    return value ? value->integer(max_size) : absent;
}

/// The item of a top-level array that an index names.
JsonValue item(const JsonValue& document, std::string_view array, const JsonValue& index) {
    const auto items = document.find(array);
    const std::size_t count = items ? items->size() : 0;
    const std::uint64_t which = index.integer(max_size);
    if (which >= count) index.refuse(fmt::format("refers to {}[{}] of {}", array, which, count));
    return (*items)[static_cast<std::size_t>(which)];
}

} // namespace

double GltfAccessor::component(std::uint64_t index, int which) const {
    const auto found = std::lower_bound(sparse_indices.begin(), sparse_indices.end(), index);
    const bool is_sparse = found != sparse_indices.end() && *found == index;
    const GltfElements& elements = is_sparse ? sparse_values : base;
    const std::uint64_t row =
        is_sparse ? static_cast<std::uint64_t>(found - sparse_indices.begin()) : index;
    return component_at(
        elements,
        static_cast<std::size_t>(row) * elements.stride +
            static_cast<std::size_t>(which) * size_of(elements.type)
    );
}

std::string_view GltfData::buffer(const JsonValue& index) {
    const JsonValue holder = item(document_, "buffers", index);
    const std::uint64_t number = index.integer(max_size);
    const std::uint64_t size = holder.at("byteLength").integer(max_size);
    const auto uri = holder.find("uri");
    std::string_view bytes;
    if (!uri) {
        if (number != 0 || !chunk_) holder.refuse("has neither a uri nor a binary chunk");
        bytes = *chunk_;
    } else if (const std::string& text = uri->string(); text.starts_with("data:")) {
        auto decoded = buffers_.find(number);
        if (decoded == buffers_.end()) {
            const std::size_t comma = text.find(',');
            if (comma == std::string::npos ||
                !std::string_view(text).substr(0, comma).ends_with(";base64"))
                uri->refuse("is a data URI without base64 data");
            reader_.claim(text.size() - comma, 1);
            auto data = decode_base64(std::string_view(text).substr(comma + 1));
            if (!data) uri->refuse("has malformed base64 data");
            decoded = buffers_.emplace(number, *std::move(data)).first;
        }
        bytes = decoded->second;
    } else {
        const auto name = decode_percent(text);
        if (!name) uri->refuse("is malformed");
        if (name->find(':') != std::string::npos)
            uri->refuse("must name a file in the scene's folder");
        auto file = files_.find(*name);
        if (file == files_.end()) {
            const auto path = resolve_inside(reader_.path().parent_path(), *name, reader_.path());
            // Larger files than the document says are refused unread.
            std::string content = read_file(path, static_cast<std::size_t>(size) + 3);
            reader_.claim(content.size(), 1);
            file = files_.emplace(*name, std::move(content)).first;
        }
        bytes = file->second;
    }
    if (bytes.size() < size)
        holder.refuse(fmt::format("says {} bytes, but there are {}", size, bytes.size()));
    return bytes.substr(0, static_cast<std::size_t>(size));
}

std::string_view GltfData::view(const JsonValue& index, std::size_t* stride) {
    const JsonValue holder = item(document_, "bufferViews", index);
    if (holder.find("extensions") && holder.at("extensions").find("EXT_meshopt_compression"))
        holder.refuse("EXT_meshopt_compression is not supported");
    const std::string_view bytes = buffer(holder.at("buffer"));
    const std::uint64_t offset = integer_or(holder, "byteOffset", 0);
    const std::uint64_t size = holder.at("byteLength").integer(max_size);
    if (offset > bytes.size() || size > bytes.size() - offset)
        holder.refuse(fmt::format("ends beyond its buffer of {} bytes", bytes.size()));
    if (size == 0) holder.refuse("is empty");
    *stride = static_cast<std::size_t>(integer_or(holder, "byteStride", 0));
    if (*stride != 0 && (*stride < 4 || *stride > 252 || *stride % 4 != 0))
        holder.refuse("has a byteStride that is not a multiple of 4 in [4, 252]");
    return bytes.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
}

GltfElements GltfData::elements(
    const JsonValue& holder,
    GltfType type,
    int components,
    bool is_normalized,
    std::uint64_t count
) {
    std::size_t stride = 0;
    const std::string_view bytes = view(holder.at("bufferView"), &stride);
    const std::size_t size = size_of(type) * static_cast<std::size_t>(components);
    if (stride == 0) stride = size;
    const std::uint64_t offset = integer_or(holder, "byteOffset", 0);
    // count <= 2^31 and stride <= 252: the product is far from 2^64.
    if (stride < size || offset > bytes.size() ||
        stride * (count - 1) + size > bytes.size() - offset)
        holder.refuse(fmt::format("its {} elements end beyond the buffer view", count));
    return {bytes.substr(static_cast<std::size_t>(offset)), stride, type, is_normalized};
}

void GltfData::read_sparse(const JsonValue& sparse, GltfAccessor& accessor) {
    const std::uint64_t count = sparse.at("count").integer(accessor.count);
    if (count == 0) sparse.refuse("replaces nothing");
    const JsonValue indices = sparse.at("indices");
    const GltfType type = component_type(indices.at("componentType"));
    if (type != GltfType::u8 && type != GltfType::u16 && type != GltfType::u32)
        indices.refuse("has a component type that is not for indices");
    const GltfElements places = elements(indices, type, 1, false, count);
    accessor.sparse_values = elements(
        sparse.at("values"),
        accessor.base.type,
        accessor.components,
        accessor.base.is_normalized,
        count
    );
    reader_.claim(count, sizeof(std::uint32_t));
    accessor.sparse_indices.reserve(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < count; ++i) {
        const double place = component_at(places, i * places.stride);
        if (!(place < static_cast<double>(accessor.count)))
            indices.refuse(fmt::format("refers to element {} of {}", place, accessor.count));
        const auto next = static_cast<std::uint32_t>(place);
        if (i > 0 && next <= accessor.sparse_indices.back()) indices.refuse("are not ascending");
        accessor.sparse_indices.push_back(next);
    }
}

GltfAccessor GltfData::accessor(const JsonValue& index, int components) {
    const JsonValue holder = item(document_, "accessors", index);
    GltfAccessor accessor;
    accessor.count = holder.at("count").integer(max_triangles);
    if (accessor.count == 0) holder.refuse("has no elements");
    accessor.components = component_count(holder.at("type"));
    if (accessor.components != components)
        holder.refuse(fmt::format(
            "has type {} where {} components belong", holder.at("type").string(), components
        ));
    const GltfType type = component_type(holder.at("componentType"));
    const auto normalized = holder.find("normalized");
    const bool is_normalized = normalized && normalized->boolean();
    accessor.base = {{}, 0, type, is_normalized};
    if (holder.find("bufferView")) {
        accessor.base = elements(holder, type, components, is_normalized, accessor.count);
    } else if (accessor.count > reader_.bytes().size()) {
        // Zeros take no bytes in the file, so nothing else bounds how many it claims.
        holder.refuse(fmt::format("claims {} zeros, more than the file has bytes", accessor.count));
    }
    if (const auto sparse = holder.find("sparse")) read_sparse(*sparse, accessor);
    return accessor;
}

std::optional<std::string> decode_base64(std::string_view text) {
    if (text.size() % 4 != 0) return std::nullopt;
    const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
    const auto digit = [](char c) -> int {
        if (c >= 'A' && c <= 'Z') return c - 'A';
        if (c >= 'a' && c <= 'z') return c - 'a' + 26;
        if (c >= '0' && c <= '9') return c - '0' + 52;
        return c == '+' ? 62 : c == '/' ? 63 : -1;
    };
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3);
    for (std::size_t i = 0; i < text.size(); i += 4) {
        const std::size_t pad = i + 4 == text.size() ? padding : 0;
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const int value = k + pad >= 4 ? 0 : digit(text[i + k]);
            if (value < 0) return std::nullopt;
            word = word << 6U | static_cast<std::uint32_t>(value);
        }
        for (std::size_t k = 0; k + pad < 3; ++k)
            bytes.push_back(static_cast<char>(word >> (16 - 8 * k) & 0xFFU));
    }
    return bytes;
}

std::optional<std::string> decode_percent(std::string_view text) {
    const auto digit = [](char c) -> int {
        if (c >= '0' && c <= '9') return c - '0';
        if (c >= 'a' && c <= 'f') return c - 'a' + 10;
        return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
    };
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            result.push_back(text[i]);
            continue;
        }
        if (text.size() - i < 3) return std::nullopt;
        const int high = digit(text[i + 1]);
        const int low = digit(text[i + 2]);
        if (high < 0 || low < 0) return std::nullopt;
        result.push_back(static_cast<char>(16 * high + low));
        i += 2;
    }
    return result;
}

} // namespace raywise::io_detail
