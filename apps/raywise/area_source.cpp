#include "area_source.hpp"
#include "exit_code.hpp"
#include "session.hpp"

#include <raywise/core/nearest_word.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/io/area_file.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/propose_areas.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <string>
#include <vector>

namespace raywise::app {

void add_area_options(CLI::App& command, std::string& file) {
    command.add_option(
        "--areas", file, "JSON file of influence areas; without it the scene's lights and cameras"
    );
}

std::vector<InfluenceArea>
open_areas(const std::string& file, const Scene& scene, const Session& session) {
    if (!file.empty()) return load_areas(file, bounds(scene));
    ProposeParams params;
    params.seed = static_cast<std::uint64_t>(session.options.seed);
    return propose_areas(scene, params);
}

const InfluenceArea& find_area(const std::vector<InfluenceArea>& areas, const std::string& name) {
    std::vector<std::string> names;
    for (const InfluenceArea& area : areas) {
        if (area.name == name) return area;
        names.push_back(area.name);
    }
    throw UsageError(fmt::format(
        "no area is named '{}'{}; there are: {}",
        name,
        did_you_mean(name, names),
        fmt::join(names, ", ")
    ));
}

} // namespace raywise::app
