#include <raywise/io/load_scene.hpp>

#include "scene_reader.hpp"

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

using Reader = void (*)(io_detail::SceneReader&);

constexpr std::array<std::pair<std::string_view, Reader>, 5> readers{
    {{".ply", io_detail::read_ply},
     {".obj", io_detail::read_obj},
     {".stl", io_detail::read_stl},
     {".gltf", io_detail::read_gltf},
     {".glb", io_detail::read_glb}}
};

Reader reader_for(const std::filesystem::path& path) {
    std::string suffix = path.extension().string();
    for (char& c : suffix)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    for (const auto& [known, reader] : readers)
        if (known == suffix) return reader;
    throw Error(
        path.string(),
        nowhere(),
        "no scene format has this suffix; known are .ply .obj .stl .gltf .glb"
    );
}

} // namespace

Scene load_scene(const std::filesystem::path& path, const LoadOptions& options) {
    LoadReport report;
    return load_scene(path, options, report);
}

Scene load_scene(
    const std::filesystem::path& path,
    const LoadOptions& options,
    LoadReport& report
) {
    const Reader read = reader_for(path);
    const std::string bytes = read_file(path, options.max_bytes);
    io_detail::SceneReader reader(path, bytes, options);
    if (bytes.empty()) reader.refuse(nowhere(), "the file is empty");
    reader.scene().name = path.stem().string();
    read(reader);
    Scene scene = reader.finish();
    report = reader.report();
    return scene;
}

} // namespace raywise
