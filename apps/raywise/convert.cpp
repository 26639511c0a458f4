// raywise convert: a scene, read or generated, in another format.
#include "exit_code.hpp"
#include "scene_source.hpp"
#include "session.hpp"

#include <raywise/io/save_scene.hpp>
#include <raywise/scene/scene.hpp>

#include <fmt/format.h>

#include <memory>
#include <string>

namespace raywise::app {

namespace {

struct ConvertOptions {
    SceneOptions source;
    std::string destination;
};

/// With --generate there is no input file, so the first file named is the output.
void settle_files(ConvertOptions& options, const CommonOptions& common) {
    if (!options.source.recipe.empty() && options.destination.empty())
        options.source.file.swap(options.destination);
    if (!common.output.empty()) {
        if (!options.destination.empty()) throw UsageError("the output is named twice: OUT and -o");
        options.destination = common.output;
    }
    if (options.destination.empty()) throw UsageError("OUT is needed: .ply .obj .stl .glb");
}

void convert(ConvertOptions options, const Session& session) {
    settle_files(options, session.options);
    const Scene scene = open_scene(options.source, session);
    session.put_files([&] { save_scene(options.destination, scene); });
    session.console.message(
        fmt::format("{}: {} triangles", options.destination, scene.triangles.size())
    );
}

} // namespace

Command add_convert(CLI::App& root, CommonOptions& options) {
    CLI::App* app =
        root.add_subcommand("convert", "Write a scene, read or generated, in another format");
    const auto own = std::make_shared<ConvertOptions>();
    add_scene_options(*app, own->source);
    app->add_option("out,--out", own->destination, "Scene file to write: .ply .obj .stl .glb")
        ->type_name("OUT");
    add_common_options(*app, options, "The same as OUT");
    return {app, {}, [own](const Session& session) { convert(*own, session); }};
}

} // namespace raywise::app
