// The influence areas of a subcommand: from a file, or out of the scene's lights and cameras.
#pragma once

#include "session.hpp"

#include <raywise/distribution/influence_area.hpp>
#include <raywise/scene/scene.hpp>

#include <string>
#include <vector>

namespace raywise::app {

/// Adds --areas.
void add_area_options(CLI::App& command, std::string& file);

/// The areas in the file; those that the scene proposes if `file` is empty.
[[nodiscard]] std::vector<InfluenceArea>
open_areas(const std::string& file, const Scene& scene, const Session& session);

/// The area of that name. Throws UsageError, with the nearest name, when there is none.
[[nodiscard]] const InfluenceArea&
find_area(const std::vector<InfluenceArea>& areas, const std::string& name);

} // namespace raywise::app
