// Reads Wavefront OBJ: vertices, faces and groups; normals, texture coordinates and materials are
// checked and left. Our own reader: tinyobjloader takes malformed numbers for zeros and follows
// references to vertices that come later. After [Wavefront92].
#include "scene_reader.hpp"
#include "text_lines.hpp"
#include "text_number.hpp"

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::io_detail {

namespace {

class ObjReader {
public:
    explicit ObjReader(SceneReader& reader) : reader_(reader), lines_(reader.bytes()) {}

    void read() {
        reserve();
        while (const auto line = next_statement())
            read_statement(*line);
        close_group();
    }

private:
    [[noreturn]] void refuse(std::string_view reason) const {
        reader_.refuse(at_line(statement_line_), reason);
    }

    /// Counts vertices and faces by their keywords: room is then claimed once, and exactly.
    void reserve() {
        std::uint64_t vertices = 0;
        std::uint64_t faces = 0;
        TextLines lines(reader_.bytes());
        while (auto line = lines.next()) {
            const std::string_view keyword = next_token(*line);
            vertices += keyword == "v" ? 1U : 0U;
            faces += keyword == "f" ? 1U : 0U;
        }
        reader_.reserve(vertices, faces);
    }

    std::optional<std::string_view> next_line() {
        const auto line = lines_.next();
        if (!line) return std::nullopt;
        const std::string_view reason = control_character_in(*line);
        if (!reason.empty()) reader_.refuse(at_line(lines_.number()), reason);
        return line;
    }

    /// A line together with those that a backslash at its end appends, without its comment.
    std::optional<std::string_view> next_statement() {
        auto line = next_line();
        statement_line_ = lines_.number();
        if (line && line->ends_with('\\')) {
            joined_.clear();
            while (line && line->ends_with('\\')) {
                joined_.append(line->substr(0, line->size() - 1)).append(" ");
                line = next_line();
            }
            if (!line) refuse("a backslash at the end of the file continues nothing");
            line = joined_.append(*line);
        }
        if (line) line = line->substr(0, line->find('#'));
        return line;
    }

    void read_statement(std::string_view line) {
        const std::string_view keyword = next_token(line);
        if (keyword.empty()) return;
        if (keyword == "v")
            read_vertex(line);
        else if (keyword == "f")
            read_face(line);
        else if (keyword == "vn")
            normals_ += read_numbers(line, 3, 3);
        else if (keyword == "vt")
            texture_points_ += read_numbers(line, 1, 3);
        else if (keyword == "o" || keyword == "g")
            read_group(line);
        else if (keyword == "l" || keyword == "p")
            read_ignored(line);
        else if (keyword != "usemtl" && keyword != "mtllib" && keyword != "s")
            refuse(fmt::format("statement '{}' is not supported", escaped(keyword, 60)));
    }

    float next_number(std::string_view& line) const {
        const std::string_view token = next_token(line);
        const auto value = parse_float(token);
        if (!value) refuse(fmt::format("'{}' is not a decimal number", escaped(token, 60)));
        return *value;
    }

    /// Three coordinates; then a weight, or a color, or both, which play no part here.
    void read_vertex(std::string_view line) {
        Vec3 vertex;
        std::size_t count = 0;
        while (line.find_first_not_of(" \t") != std::string_view::npos) {
            const float value = next_number(line);
            if (count < 3) vertex[static_cast<int>(count)] = value;
            ++count;
        }
        if (count < 3 || count == 5 || count > 7)
            refuse(fmt::format("a vertex of {} numbers", count));
        reader_.add_vertex(vertex, at_line(statement_line_));
    }

    /// Checks a normal or a texture point; 1, for the counter.
    [[nodiscard]] std::int64_t
    read_numbers(std::string_view line, std::size_t least, std::size_t most) const {
        std::size_t count = 0;
        for (; line.find_first_not_of(" \t") != std::string_view::npos; ++count)
            (void)next_number(line);
        if (count < least || count > most)
            refuse(fmt::format("{} numbers where {} to {} belong", count, least, most));
        return 1;
    }

    /// An index from 1, or from -1 backward, into `count` items so far; from 0.
    [[nodiscard]] std::uint32_t
    resolve(std::string_view token, std::int64_t count, std::string_view what) const {
        const auto index = parse_integer(token);
        if (!index) refuse(fmt::format("'{}' is not an index", escaped(token, 60)));
        if (*index == 0 || *index > count || *index < -count)
            refuse(fmt::format("face refers to {} {} of {}", what, *index, count));
        return static_cast<std::uint32_t>(*index > 0 ? *index - 1 : count + *index);
    }

    /// v, v/vt, v//vn or v/vt/vn; the vertex.
    [[nodiscard]] std::uint32_t read_corner(std::string_view token) const {
        const std::size_t first = std::min(token.find('/'), token.size());
        const auto vertices = static_cast<std::int64_t>(reader_.scene().vertices.size());
        const std::uint32_t vertex = resolve(token.substr(0, first), vertices, "vertex");
        if (first == token.size()) return vertex;
        const std::string_view rest = token.substr(first + 1);
        const std::size_t second = std::min(rest.find('/'), rest.size());
        const std::string_view texture = rest.substr(0, second);
        // "1//2" has no texture point; "1/" and "1/2/" are unfinished.
        if (!texture.empty() || second == rest.size())
            static_cast<void>(resolve(texture, texture_points_, "texture point"));
        if (second < rest.size())
            static_cast<void>(resolve(rest.substr(second + 1), normals_, "normal"));
        return vertex;
    }

    void read_face(std::string_view line) {
        corners_.clear();
        for (std::string_view token = next_token(line); !token.empty(); token = next_token(line)) {
            corners_.push_back(read_corner(token));
            if (corners_.size() > max_corners)
                refuse(fmt::format("a face of more than {} corners", max_corners));
        }
        if (count_distinct() < 3) refuse("a face with fewer than three different vertices");
        reader_.add_face(corners_, at_line(statement_line_));
    }

    /// The number of different corners, counted up to three.
    [[nodiscard]] std::size_t count_distinct() const {
        std::array<std::uint32_t, 3> seen{};
        std::size_t count = 0;
        for (const std::uint32_t corner : corners_) {
            const std::span<const std::uint32_t> before = std::span(seen).first(count);
            if (std::find(before.begin(), before.end(), corner) == before.end())
                seen[count++] = corner;
            if (count == 3) break;
        }
        return count;
    }

    /// Points and lines: rays cannot meet them, but their indices are held to the same rules.
    void read_ignored(std::string_view line) {
        std::size_t count = 0;
        for (std::string_view token = next_token(line); !token.empty(); token = next_token(line)) {
            (void)read_corner(token);
            ++count;
        }
        if (count == 0) refuse("a point or line without vertices");
        ++reader_.report().ignored;
    }

    void read_group(std::string_view line) {
        close_group();
        const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
        const std::size_t last = line.find_last_not_of(" \t");
        group_name_ = last == std::string_view::npos ? "" : line.substr(first, last + 1 - first);
    }

    /// Ends the run of triangles since the last group or object statement; empty runs leave no
    /// group.
    void close_group() {
        Scene& scene = reader_.scene();
        const std::size_t end = scene.triangles.size();
        if (end > group_first_ && !group_name_.empty()) {
            reader_.claim(3, sizeof(Group) + group_name_.size());
            scene.groups.push_back(
                {std::string(group_name_),
                 static_cast<std::uint32_t>(group_first_),
                 static_cast<std::uint32_t>(end - group_first_)}
            );
        }
        group_first_ = end;
    }

    SceneReader& reader_;
    TextLines lines_;
    std::uint64_t statement_line_ = 0;
    std::string joined_; ///< the statement, when it spans lines
    std::int64_t normals_ = 0;
    std::int64_t texture_points_ = 0;
    std::vector<std::uint32_t> corners_;
    std::string group_name_;
    std::size_t group_first_ = 0;
};

} // namespace

void read_obj(SceneReader& reader) {
    ObjReader(reader).read();
}

} // namespace raywise::io_detail
