// Reads STL, binary and ASCII; equal vertices become one. After [Burns93].
#include "byte_reader.hpp"
#include "scene_reader.hpp"
#include "text_lines.hpp"
#include "text_number.hpp"

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::io_detail {

namespace {

constexpr std::size_t header_size = 84;
constexpr std::size_t record_size = 50;

/// Gives vertices of equal coordinates one index: a table with open addressing, at most half full.
class VertexMerger {
public:
    VertexMerger(SceneReader& reader, std::uint64_t most) : reader_(reader) {
        const std::uint64_t slots = std::bit_ceil(2 * most + 2);
        reader.claim(slots, sizeof(std::uint32_t));
        table_.assign(static_cast<std::size_t>(slots), free_slot);
    }

    std::uint32_t index_of(Vec3 vertex, Place place) {
        const std::vector<Vec3>& vertices = reader_.scene().vertices;
        std::size_t slot = hash(vertex) & (table_.size() - 1);
        while (table_[slot] != free_slot) {
            if (vertices[table_[slot]] == vertex) return table_[slot];
            slot = (slot + 1) & (table_.size() - 1);
        }
        table_[slot] = static_cast<std::uint32_t>(vertices.size());
        reader_.add_vertex(vertex, place);
        return table_[slot];
    }

private:
    static constexpr std::uint32_t free_slot = 0xFFFFFFFFU;

    static std::size_t hash(Vec3 vertex) {
        std::uint64_t word = 0;
        for (int axis = 0; axis < 3; ++axis) {
            // Adding zero makes -0 and 0, which are equal, the same bits.
            word =
                (word ^ std::bit_cast<std::uint32_t>(vertex[axis] + 0.0F)) * 0x9E3779B97F4A7C15ULL;
            word ^= word >> 29U;
        }
        return static_cast<std::size_t>(word);
    }

    SceneReader& reader_;
    std::vector<std::uint32_t> table_;
};

void read_binary(SceneReader& reader, std::uint32_t count) {
    if (count > max_triangles / 3) {
        throw Error(
            ErrorKind::limit,
            reader.path().string(),
            at_byte(80),
            fmt::format("{} triangles exceed the limit of {} vertices", count, max_triangles)
        );
    }
    // Three vertices a triangle when none are equal.
    reader.reserve(std::uint64_t{3} * count, count);
    VertexMerger merger(reader, std::uint64_t{3} * count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::size_t at = header_size + std::size_t{i} * record_size;
        std::array<std::uint32_t, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t position = at + 12 * (k + 1); // the normal comes first
            const auto coordinate = [&](std::size_t axis) {
                return load<float>(reader.bytes(), position + 4 * axis);
            };
            corners[k] =
                merger.index_of({coordinate(0), coordinate(1), coordinate(2)}, at_byte(position));
        }
        reader.add_face(corners, at_byte(at));
    }
}

/// Solids of facets of three vertices, a keyword a line.
class TextReader {
public:
    explicit TextReader(SceneReader& reader)
        : reader_(reader)
        , lines_(reader.bytes())
        // A facet takes 60 bytes at least: keywords, line ends and twelve digits.
        , merger_(reader, 3 * (reader.bytes().size() / 60 + 1)) {}

    void read() {
        reader_.reserve(3 * (reader_.bytes().size() / 60 + 1), reader_.bytes().size() / 60 + 1);
        std::string_view line;
        while (next_line(line)) {
            expect(line, "solid");
            read_solid(std::string(name_in(line)));
        }
    }

private:
    [[noreturn]] void refuse(std::string_view reason) const {
        reader_.refuse(at_line(lines_.number()), reason);
    }

    /// The next line that is not blank.
    bool next_line(std::string_view& line) {
        while (const auto next = lines_.next()) {
            const std::string_view reason = control_character_in(*next);
            if (!reason.empty()) refuse(reason);
            line = *next;
            if (line.find_first_not_of(" \t") != std::string_view::npos) return true;
        }
        return false;
    }

    std::string_view need_line() {
        std::string_view line;
        if (!next_line(line)) refuse("the file ends within a solid");
        return line;
    }

    void expect(std::string_view& line, std::string_view keyword) const {
        const std::string_view token = next_token(line);
        if (token != keyword)
            refuse(fmt::format("'{}' where '{}' belongs", escaped(token, 60), keyword));
    }

    void expect_end(std::string_view line) const {
        if (!next_token(line).empty()) refuse("unexpected text at the end of the line");
    }

    static std::string_view name_in(std::string_view line) {
        const std::size_t first = line.find_first_not_of(" \t");
        if (first == std::string_view::npos) return {};
        return line.substr(first, line.find_last_not_of(" \t") + 1 - first);
    }

    float next_number(std::string_view& line) const {
        const std::string_view token = next_token(line);
        const auto value = parse_float(token);
        if (!value) refuse(fmt::format("'{}' is not a decimal number", escaped(token, 60)));
        return *value;
    }

    void read_solid(const std::string& name) {
        const std::size_t first = reader_.scene().triangles.size();
        while (true) {
            std::string_view line = need_line();
            std::string_view rest = line;
            if (next_token(rest) == "endsolid") break;
            read_facet(line);
        }
        const std::size_t count = reader_.scene().triangles.size() - first;
        if (count == 0 || name.empty()) return;
        reader_.claim(3, sizeof(Group) + name.size());
        reader_.scene().groups.push_back(
            {name, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)}
        );
    }

    void read_facet(std::string_view line) {
        expect(line, "facet");
        expect(line, "normal");
        for (int axis = 0; axis < 3; ++axis)
            (void)next_number(line); // whatever it says
        expect_end(line);
        line = need_line();
        expect(line, "outer");
        expect(line, "loop");
        expect_end(line);
        std::array<std::uint32_t, 3> corners{};
        for (std::uint32_t& corner : corners) {
            line = need_line();
            expect(line, "vertex");
            Vec3 vertex;
            for (int axis = 0; axis < 3; ++axis)
                vertex[axis] = next_number(line);
            expect_end(line);
            corner = merger_.index_of(vertex, at_line(lines_.number()));
        }
        reader_.add_face(corners, at_line(lines_.number()));
        for (const std::string_view keyword : {"endloop", "endfacet"}) {
            line = need_line();
            expect(line, keyword);
            expect_end(line);
        }
    }

    SceneReader& reader_;
    TextLines lines_;
    VertexMerger merger_;
};

} // namespace

void read_stl(SceneReader& reader) {
    const std::string_view bytes = reader.bytes();
    // A binary header may begin with "solid" too; the length decides.
    if (bytes.size() >= header_size) {
        const auto count = load<std::uint32_t>(bytes, 80);
        if (bytes.size() - header_size == std::uint64_t{count} * record_size) {
            read_binary(reader, count);
            return;
        }
        if (!bytes.starts_with("solid"))
            reader.refuse(
                at_byte(80),
                fmt::format(
                    "{} triangles need {} bytes, but the file has {}",
                    count,
                    header_size + std::uint64_t{count} * record_size,
                    bytes.size()
                )
            );
    }
    TextReader(reader).read();
}

} // namespace raywise::io_detail
