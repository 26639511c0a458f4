// The scene of a subcommand: a file, or one of the generated scenes by its recipe.
#pragma once

#include "session.hpp"

#include <raywise/scene/scene.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace raywise::app {

struct SceneOptions {
    std::string file;
    std::string recipe; ///< "courtyard:20000"; goes before the file
    bool skip_invalid = false;
    std::uint64_t max_memory = 0; ///< bytes; 0: unlimited
};

/// Adds SCENE, --generate, --skip-invalid and --max-memory.
void add_scene_options(CLI::App& command, SceneOptions& options);

/// Loads or generates the scene and says on the console what reading met. Throws UsageError when
/// there is neither file nor recipe, or both, and Error as `load_scene` does.
[[nodiscard]] Scene open_scene(const SceneOptions& options, const Session& session);

/// Throws Error (ErrorKind::limit) if work that needs about `bytes` beside the scene would exceed
/// --max-memory.
void require_memory(const SceneOptions& options, std::uint64_t bytes, const std::string& purpose);

/// The scenes that an argument names: a file, every scene file of a folder (by name), or a
/// generated scene by its recipe ("city:100000"). Throws UsageError for a word that is none of
/// these, and for a folder without scenes. `common` gives the other options.
[[nodiscard]] std::vector<SceneOptions>
scenes_named(const std::string& argument, const SceneOptions& common);

/// How the scene appears in reports: the recipe or the file.
[[nodiscard]] std::string scene_title(const SceneOptions& options);

} // namespace raywise::app
