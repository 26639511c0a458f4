// PLY, OBJ and STL: the formats that hold triangles and little else.
#include "byte_reader.hpp"
#include "scene_writer.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

namespace raywise::io_detail {

namespace {

void append_vertex(std::string& bytes, Vec3 vertex) {
    for (int axis = 0; axis < 3; ++axis)
        append(bytes, vertex[axis]);
}

/// The unit normal for STL, zero for a triangle without area.
Vec3 normal_of(const Triangle& triangle) {
    const Vec3d a = to_double(triangle.v0);
    const Vec3d normal = cross(to_double(triangle.v1) - a, to_double(triangle.v2) - a);
    return normal == Vec3d{} ? Vec3{} : to_float(normalized(normal));
}

/// Group names on one line of text: line ends and other control characters become spaces.
std::string one_line(std::string name) {
    for (char& c : name)
        if (static_cast<unsigned char>(c) < 0x20 || c == '#') c = ' ';
    while (!name.empty() && name.back() == '\\')
        name.pop_back(); // would continue the line
    return name;
}

} // namespace

std::string write_ply(const Scene& scene) {
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
        "property float y\nproperty float z\nelement face {}\n"
        "property list uchar uint vertex_indices\nend_header\n",
        scene.vertices.size(),
        scene.triangles.size()
    );
    bytes.reserve(bytes.size() + 12 * scene.vertices.size() + 13 * scene.triangles.size());
    for (const Vec3 vertex : scene.vertices)
        append_vertex(bytes, vertex);
    for (const auto& corners : scene.triangles) {
        bytes.push_back(3);
        for (const std::uint32_t corner : corners)
            append(bytes, corner);
    }
    return bytes;
}

std::string write_obj(const Scene& scene) {
    std::string text;
    const auto out = std::back_inserter(text);
    // fmt writes the shortest digits that read back as the same float, -0 included.
    for (const Vec3 v : scene.vertices)
        fmt::format_to(out, "v {} {} {}\n", v.x, v.y, v.z);
    std::size_t vertex_count = scene.vertices.size();
    std::size_t group = 0;
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
        if (group > 0) {
            const Group& last = scene.groups[group - 1];
            if (i == std::size_t{last.first} + last.count) text += "g\n";
        }
        for (; group < scene.groups.size() && scene.groups[group].first == i; ++group)
            fmt::format_to(out, "g {}\n", one_line(scene.groups[group].name));
        std::array<std::size_t, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = scene.triangles[i][k] + std::size_t{1};
            // A face must name three different vertices: a repeated one is written again.
            for (std::size_t j = 0; j < k; ++j)
                if (scene.triangles[i][j] == scene.triangles[i][k]) {
                    const Vec3 v = scene.vertices[scene.triangles[i][k]];
                    fmt::format_to(out, "v {} {} {}\n", v.x, v.y, v.z);
                    corners[k] = ++vertex_count;
                    break;
                }
        }
        fmt::format_to(out, "f {} {} {}\n", corners[0], corners[1], corners[2]);
    }
    return text;
}

std::string write_stl(const Scene& scene) {
    constexpr std::size_t title_size = 80;
    std::string bytes = "binary STL, unit as in the source";
    bytes.resize(title_size, ' ');
    append(bytes, static_cast<std::uint32_t>(scene.triangles.size()));
    bytes.reserve(bytes.size() + 50 * scene.triangles.size());
    const TriangleView view = scene.view();
    for (std::size_t i = 0; i < view.size(); ++i) {
        const Triangle triangle = view[to_prim(i)];
        append_vertex(bytes, normal_of(triangle));
        append_vertex(bytes, triangle.v0);
        append_vertex(bytes, triangle.v1);
        append_vertex(bytes, triangle.v2);
        append(bytes, std::uint16_t{0});
    }
    return bytes;
}

} // namespace raywise::io_detail
