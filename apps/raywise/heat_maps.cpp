#include "area_view.hpp"
#include "heat_maps.hpp"

#include <raywise/analysis/comparison.hpp>
#include <raywise/analysis/real_cost.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/io/heat_map.hpp>
#include <raywise/io/png.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/build_tree.hpp>
#include <raywise/toplevel/membership.hpp>
#include <raywise/trace/observer.hpp>
#include <raywise/trace/triangles.hpp>

#include <fmt/format.h>

#include <cctype>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <system_error>
#include <vector>

namespace raywise::app {

namespace {

constexpr int pixels = 60'000;
constexpr int sheet_columns = 3;

/// Letters, digits, '-' and '_' of the name; everything else as '_'.
std::string file_name(const std::string& name) {
    std::string result = name;
    for (char& c : result)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-') c = '_';
    return result;
}

/// The tree as the comparison builds it: over the area's own triangles.
Bvh local_tree(
    const Scene& scene,
    std::span<const PrimId> members,
    const InfluenceArea& area,
    const Heuristic& heuristic,
    const Executor& executor
) {
    const BuildInput input = build_input_of(scene.view(), members, executor);
    Bvh tree = build_tree(input, area.distribution, heuristic, executor).tree;
    for (PrimId& place : tree.prims)
        place = members[to_index(place)];
    return tree;
}

HeatMap trace_view(
    const AreaView& view,
    const Bvh& tree,
    const Scene& scene,
    const CostConstants& constants,
    const Executor& executor
) {
    HeatMap map;
    map.width = view.width;
    map.height = view.height;
    map.values.reserve(view.rays.size());
    for (const TracedRay& ray :
         trace_closest_counted(tree, PackedTriangles(tree, scene.view()), view.rays, executor))
        map.values.push_back(static_cast<float>(cost_of(ray.counts, constants)));
    return map;
}

} // namespace

std::vector<NamedImage> draw_heat_maps(
    const Scene& scene,
    std::span<const InfluenceArea> areas,
    const CompareParams& params,
    const Executor& executor,
    const Progress& progress
) {
    std::vector<NamedImage> images;
    std::set<std::string> names;
    std::uint64_t done = 0;
    const std::uint64_t total = areas.size() * params.variants.size();
    MembershipParams membership;
    if (params.faithful) membership.rule = Membership::vertices;

    for (const InfluenceArea& area : areas) {
        const auto view = view_of(area, pixels);
        if (!view) continue;
        const std::vector<PrimId> members =
            members_of(scene.view(), area.region, membership, executor);
        std::vector<HeatMap> maps;
        for (const Variant variant : params.variants) {
            progress.step("heat maps", done++, total);
            const Bvh tree =
                local_tree(scene, members, area, local_heuristic(variant, params), executor);
            maps.push_back(trace_view(*view, tree, scene, params.constants, executor));
            maps.back().title = name_of(variant);
        }
        const ColorScale scale = shared_scale(maps, "ordered cost per ray (box tests)");
        std::string name = file_name(area.name);
        while (!names.insert(name).second)
            name += "_";
        images.push_back(
            {name, draw_contact_sheet(maps, scale, area.name + " - " + scene.name, sheet_columns, 1)
            }
        );
        for (HeatMap& map : maps) {
            const std::string pair = file_name(map.title);
            map.title = area.name + ": " + map.title;
            images.push_back({fmt::format("{}-{}", name, pair), draw(map, scale, 2)});
        }
    }
    return images;
}

void write_images(const std::string& folder, std::span<const NamedImage> images) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure)
        throw Error(
            ErrorKind::io, folder, nowhere(), "cannot be made a folder: " + failure.message()
        );
    for (const NamedImage& named : images)
        write_png((std::filesystem::path(folder) / (named.name + ".png")).string(), named.image);
}

} // namespace raywise::app
