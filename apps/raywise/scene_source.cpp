#include "exit_code.hpp"
#include "scene_source.hpp"
#include "session.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/nearest_word.hpp>
#include <raywise/io/load_scene.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <system_error>
#include <vector>

namespace raywise::app {

namespace {

using Generator = std::function<Scene(const GenerateParams&)>;

const std::map<std::string, Generator>& generators() {
    static const std::map<std::string, Generator> table = {
        {"courtyard", generate_courtyard},
        {"city", generate_city},
        {"forest", generate_forest},
        {"terrain", generate_terrain},
        {"spheres", generate_spheres},
        {"random",
         [](const GenerateParams& params) {
             return generate_random_triangles(
                 params.triangles, static_cast<std::uint32_t>(params.seed)
             );
         }},
    };
    return table;
}

std::vector<std::string> generator_names() {
    std::vector<std::string> names;
    for (const auto& [name, generator] : generators())
        names.push_back(name);
    return names;
}

std::size_t parse_count(const std::string& text) {
    std::size_t count = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (failure != std::errc() || end != text.data() + text.size())
        throw UsageError("--generate: '" + text + "' is not a number of triangles");
    return count;
}

/// "courtyard" or "courtyard:20000".
Scene generate(const std::string& recipe, std::uint64_t seed) {
    const std::size_t colon = recipe.find(':');
    const std::string name = recipe.substr(0, colon);
    const auto found = generators().find(name);
    if (found == generators().end())
        throw UsageError(
            "--generate: unknown scene '" + name + "'" + did_you_mean(name, generator_names())
        );
    GenerateParams params;
    params.seed = seed;
    if (colon != std::string::npos) params.triangles = parse_count(recipe.substr(colon + 1));
    return found->second(params);
}

bool is_recipe(const std::string& argument) {
    return generators().contains(argument.substr(0, argument.find(':')));
}

bool has_scene_suffix(const std::filesystem::path& path) {
    std::string suffix = path.extension().string();
    for (char& letter : suffix)
        if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
    return suffix == ".obj" || suffix == ".ply" || suffix == ".stl" || suffix == ".gltf" ||
           suffix == ".glb";
}

/// Sorted by name.
std::vector<std::filesystem::path> scene_files_in(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code failure;
    for (const auto& entry : std::filesystem::directory_iterator(folder, failure))
        if (entry.is_regular_file(failure) && has_scene_suffix(entry.path()))
            files.push_back(entry.path());
    if (failure)
        throw Error(
            ErrorKind::io, folder.string(), nowhere(), "cannot be read: " + failure.message()
        );
    std::sort(files.begin(), files.end());
    return files;
}

Scene load(const SceneOptions& options, const Session& session) {
    LoadOptions load_options;
    load_options.skip_invalid = options.skip_invalid;
    if (options.max_memory != 0) load_options.max_bytes = options.max_memory;
    LoadReport met;
    Scene scene = load_scene(options.file, load_options, met);
    if (met.dropped > 0)
        session.console.message(
            fmt::format("{}: {} invalid triangles dropped", options.file, met.dropped)
        );
    if (met.degenerate > 0)
        session.console.message(fmt::format(
            "{}: {} triangles have no area and are never hit", options.file, met.degenerate
        ));
    if (met.ignored > 0)
        session.console.message(
            fmt::format("{}: {} points and lines ignored", options.file, met.ignored)
        );
    return scene;
}

} // namespace

void add_scene_options(CLI::App& command, SceneOptions& options) {
    command.add_option("scene,--scene", options.file, "Scene file: .obj .ply .stl .gltf .glb")
        ->type_name("SCENE");
    command.add_option(
        "--generate",
        options.recipe,
        "Generated scene instead of a file: courtyard, city, forest, terrain, spheres or random, "
        "with :TRIANGLES"
    );
    command.add_flag(
        "--skip-invalid", options.skip_invalid, "Drop triangles that are not finite, and count them"
    );
    command
        .add_option(
            "--max-memory",
            options.max_memory,
            "Refuse what needs more memory, such as 512M or 4G; 0: no limit"
        )
        ->transform(CLI::AsSizeValue(false))
        ->capture_default_str();
}

Scene open_scene(const SceneOptions& options, const Session& session) {
    if (options.file.empty() == options.recipe.empty())
        throw UsageError(
            options.file.empty() ? "a scene is needed: a file, or --generate NAME:TRIANGLES"
                                 : "a scene is a file or --generate, not both"
        );
    return options.recipe.empty()
               ? load(options, session)
               : generate(options.recipe, static_cast<std::uint64_t>(session.options.seed));
}

std::vector<SceneOptions> scenes_named(const std::string& argument, const SceneOptions& common) {
    namespace fs = std::filesystem;
    SceneOptions options = common;
    std::error_code failure;
    if (fs::is_directory(argument, failure)) {
        std::vector<SceneOptions> scenes;
        for (const fs::path& file : scene_files_in(argument)) {
            options.file = file.string();
            scenes.push_back(options);
        }
        if (scenes.empty())
            throw UsageError("'" + argument + "': there are no scene files in this folder");
        return scenes;
    }
    if (is_recipe(argument)) {
        options.recipe = argument;
    } else if (!fs::exists(argument, failure) && !has_scene_suffix(argument)) {
        throw UsageError(
            "'" + argument + "' is no file, folder or generated scene" +
            did_you_mean(argument.substr(0, argument.find(':')), generator_names())
        );
    } else {
        options.file = argument;
    }
    return {options};
}

void require_memory(const SceneOptions& options, std::uint64_t bytes, const std::string& purpose) {
    if (options.max_memory != 0 && bytes > options.max_memory)
        throw Error(
            ErrorKind::limit,
            {},
            nowhere(),
            fmt::format(
                "{} needs about {} MiB, --max-memory allows {} MiB",
                purpose,
                bytes >> 20U,
                options.max_memory >> 20U
            )
        );
}

std::string scene_title(const SceneOptions& options) {
    return options.recipe.empty() ? options.file : options.recipe;
}

} // namespace raywise::app
