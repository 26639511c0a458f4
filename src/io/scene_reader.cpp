#include "scene_reader.hpp"
#include "triangulate.hpp"

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/io/load_scene.hpp>
#include <raywise/scene/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace raywise::io_detail {

namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

bool is_storable(Vec3 vertex) {
    const Vec3 m = abs(vertex);
    return m.x <= max_coordinate && m.y <= max_coordinate && m.z <= max_coordinate;
}

} // namespace

SceneReader::SceneReader(
    std::filesystem::path path,
    std::string_view bytes,
    const LoadOptions& options
)
    : path_(std::move(path))
    , bytes_(bytes)
    , skip_invalid_(options.skip_invalid)
    , limit_(options.max_bytes)
    , left_(options.max_bytes) {
    claim(bytes.size(), 1);
}

void SceneReader::refuse(Place place, std::string_view reason) const {
    throw Error(path_.string(), place, reason);
}

void SceneReader::claim(std::uint64_t count, std::uint64_t size) {
    if (size != 0 && count > left_ / size) {
        throw Error(
            ErrorKind::limit,
            path_.string(),
            nowhere(),
            fmt::format("reading it takes more than the memory limit of {} bytes", limit_)
        );
    }
    left_ -= static_cast<std::size_t>(count * size);
}

void SceneReader::reserve(std::uint64_t vertices, std::uint64_t triangles) {
    const std::uint64_t all_vertices = scene_.vertices.size() + vertices;
    const std::uint64_t all_triangles = scene_.triangles.size() + triangles;
    if (all_vertices > max_triangles || all_triangles > max_triangles) {
        throw Error(
            ErrorKind::limit,
            path_.string(),
            nowhere(),
            fmt::format(
                "{} vertices and {} triangles exceed the limit of {}",
                all_vertices,
                all_triangles,
                max_triangles
            )
        );
    }
    claim(vertices, sizeof(Vec3));
    claim(triangles, 3 * sizeof(std::uint32_t));
    scene_.vertices.reserve(static_cast<std::size_t>(all_vertices));
    scene_.triangles.reserve(static_cast<std::size_t>(all_triangles));
}

void SceneReader::add_vertex(Vec3 vertex, Place place) {
    if (!is_storable(vertex)) {
        if (!skip_invalid_) {
            refuse(
                place,
                is_finite(vertex) ? "a coordinate is beyond 2^60"
                                  : "a coordinate is not finite in single precision"
            );
        }
        vertex = {not_a_number, not_a_number, not_a_number};
        ++marked_;
    }
    scene_.vertices.push_back(vertex);
}

bool SceneReader::is_marked(std::uint32_t index) const {
    return std::isnan(scene_.vertices[index].x);
}

void SceneReader::add_face(std::span<const std::uint32_t> corners, Place place) {
    if (corners.size() > max_corners)
        refuse(
            place,
            fmt::format("a face of {} corners; at most {} are read", corners.size(), max_corners)
        );
    const auto marked = [&](std::uint32_t corner) { return is_marked(corner); };
    if (marked_ != 0 && std::any_of(corners.begin(), corners.end(), marked)) {
        report_.dropped += corners.size() - 2;
        return;
    }
    // The rooms for one triangle a face were reserved; further ones are claimed as they come, with
    // what a growing vector takes beside its content.
    constexpr std::uint64_t growing = 3;
    claim(corners.size() - 3, growing * sizeof(scene_.triangles[0]));
    if (corners.size() == 3) {
        scene_.triangles.push_back({corners[0], corners[1], corners[2]});
    } else {
        ++report_.polygons;
        triangulate(scene_.vertices, corners, scene_.triangles);
    }
    if (scene_.triangles.size() > max_triangles)
        throw Error(ErrorKind::limit, path_.string(), place, "more than 2,147,483,647 triangles");
}

void SceneReader::remove_marked() {
    std::vector<std::uint32_t> moved(scene_.vertices.size());
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < moved.size(); ++i) {
        moved[i] = kept;
        if (!is_marked(i)) scene_.vertices[kept++] = scene_.vertices[i];
    }
    scene_.vertices.resize(kept);
    for (auto& corners : scene_.triangles)
        for (std::uint32_t& corner : corners)
            corner = moved[corner];
}

Scene SceneReader::finish() {
    if (scene_.triangles.empty()) {
        refuse(
            nowhere(),
            report_.dropped == 0 ? "it holds no triangles"
                                 : "it holds no triangles but invalid ones"
        );
    }
    if (marked_ != 0) {
        claim(scene_.vertices.size(), sizeof(std::uint32_t));
        remove_marked();
    }
    validate(scene_); // of what is not a vertex: groups, lights, cameras
    report_.degenerate = count_degenerate(scene_);
    return std::move(scene_);
}

float narrowed(double value) {
    // The conversion of a number beyond the largest float is undefined. One between it and the
    // midpoint to 2^128 rounds to it.
    constexpr auto largest = static_cast<double>(std::numeric_limits<float>::max());
    constexpr double midpoint = 0x1.ffffffp127;
    if (std::abs(value) >= midpoint)
        return value > 0 ? std::numeric_limits<float>::infinity()
                         : -std::numeric_limits<float>::infinity();
    return static_cast<float>(std::clamp(value, -largest, largest));
}

} // namespace raywise::io_detail
