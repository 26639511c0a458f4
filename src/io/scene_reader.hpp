// What the readers of scene formats share: the file, the memory limit, faces and the last checks.
#pragma once

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/io/load_scene.hpp>
#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace raywise::io_detail {

/// A scene that is being read from one file.
class SceneReader {
public:
    /// `bytes` is the file's content and outlives the reader.
    SceneReader(std::filesystem::path path, std::string_view bytes, const LoadOptions& options);

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

    [[nodiscard]] std::string_view bytes() const { return bytes_; }

    [[nodiscard]] Scene& scene() { return scene_; }

    [[nodiscard]] LoadReport& report() { return report_; }

    [[noreturn]] void refuse(Place place, std::string_view reason) const;

    /// Takes count * size bytes from the memory limit, before they are allocated. Throws Error of
    /// kind limit when they exceed what is left.
    void claim(std::uint64_t count, std::uint64_t size);

    /// Claims and reserves room for so many vertices and triangles more.
    void reserve(std::uint64_t vertices, std::uint64_t triangles);

    /// Appends a vertex. One that is not finite or beyond `max_coordinate` is refused, or marked
    /// when the invalid are to be skipped: a face that uses it is dropped.
    void add_vertex(Vec3 vertex, Place place);

    /// Appends a face of at least three corners, whose indices the caller has checked. Four and
    /// more are triangulated.
    void add_face(std::span<const std::uint32_t> corners, Place place);

    /// Removes marked vertices, counts the degenerate, refuses a scene without triangles.
    [[nodiscard]] Scene finish();

private:
    [[nodiscard]] bool is_marked(std::uint32_t index) const;
    void remove_marked();

    std::filesystem::path path_;
    std::string_view bytes_;
    bool skip_invalid_;
    std::size_t limit_;
    std::size_t left_;
    Scene scene_;
    LoadReport report_;
    std::size_t marked_ = 0;
};

/// The most corners of a face: triangulation takes time in the square of their number.
inline constexpr std::size_t max_corners = 4096;

/// `value` rounded to float; infinite beyond its range.
[[nodiscard]] float narrowed(double value);

/// The readers. Each fills the reader's scene; throws Error when the content is not of its format.
void read_obj(SceneReader& reader);
void read_ply(SceneReader& reader);
void read_stl(SceneReader& reader);
void read_gltf(SceneReader& reader); ///< JSON
void read_glb(SceneReader& reader);  ///< the binary container

} // namespace raywise::io_detail
