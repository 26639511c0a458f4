// Reads PLY: ASCII and binary of either byte order, any scalar types, extra elements and properties
// skipped. After [Turk94].
#include "byte_reader.hpp"
#include "ply_header.hpp"
#include "scene_reader.hpp"
#include "text_lines.hpp"
#include "text_number.hpp"

#include <raywise/core/error.hpp>

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace raywise::io_detail {

namespace {

/// Hands out the numbers of a binary body.
class BinaryBody {
public:
    BinaryBody(const SceneReader& reader, const PlyHeader& header)
        : reader_(reader)
        , at_(header.size)
        , order_(
              header.format == PlyFormat::little_endian ? std::endian::little : std::endian::big
          ) {}

    [[nodiscard]] Place place() const { return at_byte(at_); }

    void begin_element() {}

    void end_element() {}

    double next(PlyType type) {
        const std::size_t size = size_of(type);
        if (reader_.bytes().size() - at_ < size) reader_.refuse(place(), "the file ends too early");
        const std::size_t at = at_;
        at_ += size;
        switch (type) {
        case PlyType::i8:
            return number<std::int8_t>(at);
        case PlyType::u8:
            return number<std::uint8_t>(at);
        case PlyType::i16:
            return number<std::int16_t>(at);
        case PlyType::u16:
            return number<std::uint16_t>(at);
        case PlyType::i32:
            return number<std::int32_t>(at);
        case PlyType::u32:
            return number<std::uint32_t>(at);
        case PlyType::f32:
            return static_cast<double>(number<float>(at));
        case PlyType::f64:
            return number<double>(at);
        }
        return 0;
    }

    void finish() const {
        if (at_ != reader_.bytes().size()) reader_.refuse(place(), "data beyond the last element");
    }

private:
    template <class T>
    [[nodiscard]] T number(std::size_t at) const {
        return load<T>(reader_.bytes(), at, order_);
    }

    const SceneReader& reader_;
    std::size_t at_;
    std::endian order_;
};

/// Hands out the numbers of a text body, one element a line.
class TextBody {
public:
    TextBody(const SceneReader& reader, const PlyHeader& header)
        : reader_(reader)
        , lines_(reader.bytes().substr(header.size))
        , first_line_(header.line_count) {}

    [[nodiscard]] Place place() const { return at_line(first_line_ + lines_.number()); }

    void begin_element() {
        const auto line = lines_.next();
        if (!line) reader_.refuse(place(), "the file ends too early");
        const std::string_view reason = control_character_in(*line);
        if (!reason.empty()) reader_.refuse(place(), reason);
        line_ = *line;
    }

    void end_element() {
        if (!next_token(line_).empty()) reader_.refuse(place(), "more numbers than properties");
    }

    double next(PlyType type) {
        const std::string_view token = next_token(line_);
        if (token.empty()) reader_.refuse(place(), "fewer numbers than properties");
        std::optional<double> value;
        if (type == PlyType::f64)
            value = parse_double(token);
        else if (type == PlyType::f32)
            value = parse_float(token);
        else
            value = parse_integer_of(type, token);
        if (!value)
            reader_.refuse(
                place(), fmt::format("'{}' is not a number of its type", escaped(token, 60))
            );
        return *value;
    }

    void finish() {
        while (const auto line = lines_.next())
            if (line->find_first_not_of(" \t") != std::string_view::npos)
                reader_.refuse(place(), "data beyond the last element");
    }

private:
    static std::optional<double> parse_integer_of(PlyType type, std::string_view token) {
        const auto value = parse_integer(token);
        if (!value) return std::nullopt;
        const bool is_signed = type == PlyType::i8 || type == PlyType::i16 || type == PlyType::i32;
        const std::int64_t bits =
            static_cast<std::int64_t>(8 * size_of(type)) - (is_signed ? 1 : 0);
        const std::int64_t end = std::int64_t{1} << bits;
        if (*value >= end || *value < (is_signed ? -end : 0)) return std::nullopt;
        return static_cast<double>(*value);
    }

    const SceneReader& reader_;
    TextLines lines_;
    std::uint64_t first_line_;
    std::string_view line_;
};

/// Reads the elements of a body, whichever its encoding.
template <class Body>
class BodyReader {
public:
    BodyReader(SceneReader& reader, const PlyHeader& header, Body body)
        : reader_(reader), header_(header), body_(body) {}

    void read() {
        reserve();
        bool has_vertices = false;
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") {
                read_vertices(element);
                has_vertices = true;
            } else if (element.name == "face") {
                if (!has_vertices) refuse("faces before the vertices are not supported");
                read_faces(element);
            } else if (element.name == "tristrips" && element.count != 0) {
                refuse("element 'tristrips' is not supported");
            } else {
                for (std::uint64_t i = 0; i < element.count; ++i)
                    skip(element);
            }
        }
        body_.finish();
    }

private:
    [[noreturn]] void refuse(std::string_view reason) const {
        reader_.refuse(body_.place(), reason);
    }

    void reserve() {
        std::uint64_t vertices = 0;
        std::uint64_t faces = 0;
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") vertices = element.count;
            if (element.name == "face") faces = element.count;
        }
        // A face takes its count and three indices at least, or six characters.
        if (faces > reader_.bytes().size() / 4)
            refuse("the header claims more faces than the file can hold");
        reader_.reserve(vertices, faces);
    }

    void skip(const PlyElement& element) {
        body_.begin_element();
        for (const PlyProperty& property : element.properties)
            skip(property);
        body_.end_element();
    }

    void skip(const PlyProperty& property) {
        const std::uint64_t count = property.is_list ? next_length(property) : 1;
        for (std::uint64_t k = 0; k < count; ++k)
            body_.next(property.type);
    }

    std::uint64_t next_length(const PlyProperty& property) {
        const double length = body_.next(property.count_type);
        if (length < 0) refuse("a list of negative length");
        return static_cast<std::uint64_t>(length);
    }

    void read_vertices(const PlyElement& element) {
        constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
        std::array<std::size_t, 3> columns{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            columns[axis] = column_of(element, names[axis]);
        std::vector<double> row(element.properties.size());
        for (std::uint64_t i = 0; i < element.count; ++i) {
            const Place place = body_.place();
            body_.begin_element();
            for (std::size_t k = 0; k < row.size(); ++k) {
                if (element.properties[k].is_list)
                    skip(element.properties[k]);
                else
                    row[k] = body_.next(element.properties[k].type);
            }
            body_.end_element();
            reader_.add_vertex(
                {narrowed(row[columns[0]]), narrowed(row[columns[1]]), narrowed(row[columns[2]])},
                place.unit == Place::Unit::line ? body_.place() : place
            );
        }
    }

    [[nodiscard]] std::size_t column_of(const PlyElement& element, std::string_view name) const {
        for (std::size_t k = 0; k < element.properties.size(); ++k)
            if (element.properties[k].name == name && !element.properties[k].is_list) return k;
        if (element.count == 0) return 0;
        refuse(fmt::format("the vertices have no property '{}'", name));
    }

    void read_faces(const PlyElement& element) {
        const PlyProperty* indices = nullptr;
        for (const PlyProperty& property : element.properties)
            if (property.name == "vertex_indices" || property.name == "vertex_index") {
                if (indices != nullptr) refuse("two lists of vertex indices in a face");
                indices = &property;
            }
        if (element.count == 0) return;
        if (indices == nullptr || !indices->is_list || !is_integer(indices->type))
            refuse("the faces have no list 'vertex_indices' of integers");
        std::vector<std::uint32_t> corners;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            body_.begin_element();
            for (const PlyProperty& property : element.properties) {
                if (&property == indices)
                    read_corners(property, corners);
                else
                    skip(property);
            }
            body_.end_element();
            reader_.add_face(corners, body_.place());
        }
    }

    void read_corners(const PlyProperty& property, std::vector<std::uint32_t>& corners) {
        const std::uint64_t count = next_length(property);
        if (count < 3) refuse(fmt::format("a face of {} corners", count));
        if (count > max_corners)
            refuse(fmt::format("a face of {} corners; at most {} are read", count, max_corners));
        const auto vertex_count = static_cast<double>(reader_.scene().vertices.size());
        corners.clear();
        for (std::uint64_t k = 0; k < count; ++k) {
            const double index = body_.next(property.type);
            if (!(index >= 0 && index < vertex_count))
                refuse(fmt::format("face refers to vertex {} of {}", index, vertex_count));
            corners.push_back(static_cast<std::uint32_t>(index));
        }
    }

    SceneReader& reader_;
    const PlyHeader& header_;
    Body body_;
};

} // namespace

void read_ply(SceneReader& reader) {
    const PlyHeader header = read_ply_header(reader);
    if (header.format == PlyFormat::ascii)
        BodyReader(reader, header, TextBody(reader, header)).read();
    else
        BodyReader(reader, header, BinaryBody(reader, header)).read();
}

} // namespace raywise::io_detail
