#include "io/scene_reader.hpp"
#include "ply_header.hpp"
#include "text_lines.hpp"
#include "text_number.hpp"

#include <raywise/core/error.hpp>

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

constexpr std::size_t max_line = 4096;
constexpr std::size_t max_properties = 1024;

std::optional<PlyType> type_named(std::string_view name) {
    using enum PlyType;
    constexpr std::array<std::pair<std::string_view, PlyType>, 16> types{
        {{"char", i8},
         {"int8", i8},
         {"uchar", u8},
         {"uint8", u8},
         {"short", i16},
         {"int16", i16},
         {"ushort", u16},
         {"uint16", u16},
         {"int", i32},
         {"int32", i32},
         {"uint", u32},
         {"uint32", u32},
         {"float", f32},
         {"float32", f32},
         {"double", f64},
         {"float64", f64}}
    };
    for (const auto& [known, type] : types)
        if (known == name) return type;
    return std::nullopt;
}

/// The header's statements, line by line.
class HeaderParser {
public:
    explicit HeaderParser(const SceneReader& reader) : reader_(reader), lines_(reader.bytes()) {}

    PlyHeader parse() {
        if (next_line() != "ply") refuse("not a PLY file: the first line must be 'ply'");
        parse_format(next_line());
        while (true) {
            std::string_view line = next_line();
            const std::string_view word = next_token(line);
            if (word == "comment" || word == "obj_info") continue;
            if (word == "element")
                parse_element(line);
            else if (word == "property")
                parse_property(line);
            else if (word == "end_header" && next_token(line).empty())
                break;
            else
                refuse(fmt::format("unknown header statement '{}'", escaped(word, 60)));
        }
        header_.size = lines_.offset();
        header_.line_count = lines_.number();
        check_claims();
        return std::move(header_);
    }

private:
    [[noreturn]] void refuse(std::string_view reason) const {
        reader_.refuse(at_line(std::max<std::uint64_t>(lines_.number(), 1)), reason);
    }

    std::string_view next_line() {
        const auto line = lines_.next();
        if (!line) refuse("the header has no end");
        if (line->size() > max_line) refuse("a header line of more than 4,096 bytes");
        const std::string_view reason = control_character_in(*line);
        if (!reason.empty()) refuse(reason);
        return *line;
    }

    void parse_format(std::string_view line) {
        if (next_token(line) != "format") refuse("the second line must be the format");
        const std::string_view name = next_token(line);
        if (name == "ascii")
            header_.format = PlyFormat::ascii;
        else if (name == "binary_little_endian")
            header_.format = PlyFormat::little_endian;
        else if (name == "binary_big_endian")
            header_.format = PlyFormat::big_endian;
        else
            refuse(fmt::format("unknown format '{}'", escaped(name, 60)));
        if (next_token(line) != "1.0") refuse("the version must be 1.0");
        end_statement(line);
    }

    void parse_element(std::string_view line) {
        PlyElement element;
        element.name = next_token(line);
        const auto count = parse_integer(next_token(line));
        if (element.name.empty() || !count || *count < 0)
            refuse("an element needs a name and a count");
        element.count = static_cast<std::uint64_t>(*count);
        for (const PlyElement& other : header_.elements)
            if (other.name == element.name) refuse("an element name is used twice");
        end_statement(line);
        header_.elements.push_back(std::move(element));
        if (header_.elements.size() > max_properties) refuse("more than 1,024 elements");
    }

    void parse_property(std::string_view line) {
        if (header_.elements.empty()) refuse("a property before the first element");
        PlyProperty property;
        std::string_view type = next_token(line);
        if (type == "list") {
            property.is_list = true;
            property.count_type = parse_type(next_token(line));
            if (!is_integer(property.count_type))
                refuse("a list's count must be of an integer type");
            type = next_token(line);
        }
        property.type = parse_type(type);
        property.name = next_token(line);
        if (property.name.empty()) refuse("a property needs a name");
        auto& properties = header_.elements.back().properties;
        for (const PlyProperty& other : properties)
            if (other.name == property.name) refuse("a property name is used twice in an element");
        end_statement(line);
        properties.push_back(std::move(property));
        if (properties.size() > max_properties) refuse("more than 1,024 properties in an element");
    }

    [[nodiscard]] PlyType parse_type(std::string_view name) const {
        const auto type = type_named(name);
        if (!type) refuse(fmt::format("unknown type '{}'", escaped(name, 60)));
        return *type;
    }

    void end_statement(std::string_view line) const {
        if (!next_token(line).empty()) refuse("unexpected text at the end of the statement");
    }

    /// Bytes that an element takes at least: empty lists, one-digit numbers.
    [[nodiscard]] std::uint64_t least_size(const PlyElement& element) const {
        std::uint64_t size = 0;
        for (const PlyProperty& property : element.properties) {
            if (header_.format == PlyFormat::ascii)
                size += 2;
            else
                size += size_of(property.is_list ? property.count_type : property.type);
        }
        return size;
    }

    /// Refuses counts that the rest of the file cannot hold, before anything is allocated for them.
    void check_claims() const {
        // The last line of a text may lack its end.
        std::uint64_t left = reader_.bytes().size() - header_.size + 1;
        for (const PlyElement& element : header_.elements) {
            if (element.count == 0) continue;
            const std::uint64_t size = least_size(element);
            if (size == 0)
                refuse(fmt::format("element '{}' has no properties", escaped(element.name, 60)));
            if (element.count > left / size)
                refuse(fmt::format(
                    "the header claims {} elements '{}', more than the file can hold",
                    element.count,
                    escaped(element.name, 60)
                ));
            left -= element.count * size;
        }
    }

    const SceneReader& reader_;
    TextLines lines_;
    PlyHeader header_;
};

} // namespace

PlyHeader read_ply_header(const SceneReader& reader) {
    return HeaderParser(reader).parse();
}

} // namespace raywise::io_detail
