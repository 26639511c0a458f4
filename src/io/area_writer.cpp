// Writes influence areas as JSON.
#include <raywise/core/error.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/measured.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/distribution/uniform.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/io/area_file.hpp>
#include <raywise/io/files.hpp>
#include <raywise/io/ray_file.hpp>

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <variant>

namespace raywise {

namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json to_json(BasicVec3<T> v) {
    return Json::array({v.x, v.y, v.z});
}

Json to_json(const Aabb& box) {
    return {{"lo", to_json(box.lo)}, {"hi", to_json(box.hi)}};
}

void add_frame(Json& holder, const Frame& frame) {
    holder["direction"] = to_json(frame.forward);
    holder["right"] = to_json(frame.right);
    holder["up"] = to_json(frame.up);
}

struct RegionWriter {
    Json operator()(const Aabb& box) const {
        return {{"kind", "box"}, {"lo", to_json(box.lo)}, {"hi", to_json(box.hi)}};
    }

    Json operator()(const Obb& box) const {
        Json result{{"kind", "obb"}, {"center", to_json(box.center)}, {"half", to_json(box.half)}};
        add_frame(result, box.frame);
        return result;
    }

    Json operator()(const Frustum& frustum) const {
        Json result{{"kind", "frustum"}, {"eye", to_json(frustum.eye)}};
        add_frame(result, frustum.frame);
        result["tan_x"] = frustum.tan_x;
        result["tan_y"] = frustum.tan_y;
        result["near"] = frustum.near;
        result["far"] = frustum.far;
        return result;
    }
};

std::string name_of(Emission emission) {
    switch (emission) {
    case Emission::pinhole:
        return "pinhole";
    case Emission::isotropic:
        return "isotropic";
    case Emission::yaw_pitch:
        return "yaw_pitch";
    }
    return {};
}

/// Adds what an area's distribution holds; rays go to a file beside that of the areas.
struct DistributionWriter {
    Json& area;
    std::filesystem::path rays_path;

    void operator()(const UniformDistribution& uniform) const {
        area["kind"] = "uniform";
        area["bounds"] = to_json(uniform.bounds());
    }

    void operator()(const ParallelDistribution& parallel) const {
        const ParallelParams& params = parallel.params();
        Json window{{"point", to_json(params.point)}};
        add_frame(window, params.frame);
        window["half_width"] = params.half_width;
        window["half_height"] = params.half_height;
        window["start_depth"] = params.start_depth;
        area["kind"] = "parallel";
        area["window"] = window;
        area["cone_half_angle_deg"] = params.cone_half_angle_deg;
    }

    void operator()(const RadialDistribution& radial) const {
        const RadialParams& params = radial.params();
        Json view{{"eye", to_json(params.eye)}};
        add_frame(view, params.frame);
        if (params.window) {
            view["tan_x"] = params.window->tan_x;
            view["tan_y"] = params.window->tan_y;
        }
        view["start_depth"] = params.start_depth;
        area["kind"] = "radial";
        area["view"] = view;
        area["emission"] = name_of(params.emission);
        area["radius"] = params.radius;
    }

    void operator()(const MeasuredDistribution& measured) const {
        const MeasuredParams& params = measured.params();
        save_recorded_rays(rays_path, params.rays);
        area["kind"] = "measured";
        area["rays"] = rays_path.filename().string();
        area["bounds"] = to_json(params.bounds);
        area["shrinkage"] = params.shrinkage;
    }
};

} // namespace

void save_areas(const std::filesystem::path& path, std::span<const InfluenceArea> areas) {
    Json document{{"schema_version", area_file_schema_version}, {"areas", Json::array()}};
    for (std::size_t i = 0; i < areas.size(); ++i) {
        Json area{{"name", areas[i].name}};
        const std::string rays = path.stem().string() + "." + std::to_string(i) + ".npz";
        std::visit(DistributionWriter{area, path.parent_path() / rays}, areas[i].distribution);
        area["region"] = std::visit(RegionWriter{}, areas[i].region);
        area["density"] = areas[i].density;
        area["affinity"] = {{"angle_deg", areas[i].affinity.angle_deg}};
        if (areas[i].affinity.distance) area["affinity"]["distance"] = *areas[i].affinity.distance;
        document["areas"].push_back(area);
    }
    std::string text;
    try {
        text = document.dump(2) + "\n";
    } catch (const Json::exception&) {
        throw Error(path.string(), nowhere(), "the name of an area is not UTF-8");
    }
    write_file_atomically(path, text);
}

} // namespace raywise
