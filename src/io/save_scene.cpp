#include <raywise/io/save_scene.hpp>

#include "scene_writer.hpp"

#include <raywise/core/error.hpp>
#include <raywise/io/files.hpp>
#include <raywise/scene/scene.hpp>

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace raywise {

namespace {

using Writer = std::string (*)(const Scene&);

constexpr std::array<std::pair<std::string_view, Writer>, 4> writers{
    {{".ply", io_detail::write_ply},
     {".obj", io_detail::write_obj},
     {".stl", io_detail::write_stl},
     {".glb", io_detail::write_glb}}
};

} // namespace

void save_scene(const std::filesystem::path& path, const Scene& scene) {
    std::string suffix = path.extension().string();
    for (char& c : suffix)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    for (const auto& [known, write] : writers)
        if (known == suffix) {
            validate(scene);
            if (scene.triangles.empty())
                throw Error(path.string(), nowhere(), "a scene without triangles is not written");
            write_file_atomically(path, write(scene));
            return;
        }
    throw Error(
        path.string(),
        nowhere(),
        "scenes are not written with this suffix; known are .ply .obj .stl .glb"
    );
}

} // namespace raywise
