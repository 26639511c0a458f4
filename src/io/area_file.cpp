#include <raywise/io/area_file.hpp>

#include "io/json_fields.hpp"
#include "io/json_reader.hpp"

#include <raywise/core/error.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/distribution/uniform.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/io/files.hpp>
#include <raywise/io/ray_file.hpp>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace raywise {

namespace {

using detail::Json;
using detail::JsonFields;

constexpr std::size_t size_limit = 1U << 26U;

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

Aabb read_box(JsonFields& fields) {
    const Vec3d lo = fields.vector("lo"), hi = fields.vector("hi");
    const Aabb box{to_float(lo), to_float(hi)};
    if (box.is_empty() || !is_finite(box.lo) || !is_finite(box.hi))
        fields.refuse("'lo' is not below 'hi', or a coordinate is too large");
    return box;
}

/// Forward by `direction`, with a roll; or with `right` and `up`, which are then taken as they are.
Frame read_frame(JsonFields& fields) {
    const Vec3d direction = fields.vector("direction");
    if (fields.optional("right") == nullptr && fields.optional("up") == nullptr)
        return frame_along(direction, radians(fields.number_or("roll_deg", 0)));
    const Frame frame{fields.vector("right"), fields.vector("up"), direction};
    constexpr double tolerance = 1e-6;
    if (!(length(cross(frame.right, frame.up) - frame.forward) < tolerance &&
          std::abs(length(frame.right) - 1) < tolerance &&
          std::abs(length(frame.up) - 1) < tolerance))
        fields.refuse("'right', 'up' and 'direction' are not orthonormal and right-handed");
    return frame;
}

/// Half a field of view by its tangents, or by the full angles.
RadialWindow read_tangents(JsonFields& fields) {
    if (fields.optional("tan_x") == nullptr && fields.optional("tan_y") == nullptr)
        return window_of_fov(fields.number("fov_x_deg"), fields.number("fov_y_deg"));
    const RadialWindow window{fields.number("tan_x"), fields.number("tan_y")};
    if (!(window.tan_x > 0 && window.tan_y > 0)) fields.refuse("a tangent is not above 0");
    return window;
}

Obb read_obb(JsonFields& fields) {
    const Obb box{fields.vector("center"), read_frame(fields), fields.vector("half")};
    if (!(box.half.x >= 0 && box.half.y >= 0 && box.half.z >= 0))
        fields.refuse("'half' is below 0");
    return box;
}

Frustum read_frustum(JsonFields& fields) {
    Frustum frustum;
    frustum.eye = fields.vector("eye");
    frustum.frame = read_frame(fields);
    const RadialWindow window = read_tangents(fields);
    frustum.tan_x = window.tan_x;
    frustum.tan_y = window.tan_y;
    frustum.near = fields.number_or("near", 0);
    frustum.far = fields.number("far");
    if (!(frustum.near >= 0 && frustum.far > frustum.near))
        fields.refuse("0 <= near < far does not hold");
    return frustum;
}

Region read_region(const Json& json, const JsonFields& parent) {
    JsonFields fields(json, parent.path(), parent.context() + ", region");
    const std::string kind = fields.text("kind");
    const auto read = [&]() -> Region {
        if (kind == "box") return read_box(fields);
        if (kind == "obb") return read_obb(fields);
        if (kind == "frustum") return read_frustum(fields);
        fields.refuse("kind '" + kind + "' is not box, obb or frustum");
    };
    Region region = read();
    fields.refuse_others();
    return region;
}

Affinity read_affinity(JsonFields& parent) {
    Affinity affinity;
    const Json* json = parent.optional("affinity");
    if (json == nullptr) return affinity;
    JsonFields fields(*json, parent.path(), parent.context() + ", affinity");
    affinity.angle_deg = fields.number_or("angle_deg", affinity.angle_deg);
    if (fields.optional("distance") != nullptr) affinity.distance = fields.number("distance");
    fields.refuse_others();
    return affinity;
}

Emission read_emission(JsonFields& fields, const std::string& fallback) {
    const std::string name = fields.text_or("emission", fallback);
    if (name == "pinhole") return Emission::pinhole;
    if (name == "isotropic") return Emission::isotropic;
    if (name == "yaw_pitch") return Emission::yaw_pitch;
    fields.refuse("emission '" + name + "' is not pinhole, isotropic or yaw_pitch");
}

/// The window of parallel rays, given instead of derived from direction and region.
ParallelDistribution read_window(const Json& json, JsonFields& parent) {
    JsonFields fields(json, parent.path(), parent.context() + ", window");
    ParallelParams params;
    params.point = fields.vector("point");
    params.frame = read_frame(fields);
    params.half_width = fields.number("half_width");
    params.half_height = fields.number("half_height");
    params.start_depth = fields.number_or("start_depth", 0);
    fields.refuse_others();
    params.cone_half_angle_deg = parent.number_or("cone_half_angle_deg", 0);
    return ParallelDistribution(params);
}

/// The view of radial rays, given instead of derived from apex and region. All directions when it
/// has no field of view.
RadialDistribution read_view(const Json& json, JsonFields& parent) {
    JsonFields fields(json, parent.path(), parent.context() + ", view");
    RadialParams params;
    params.eye = fields.vector("eye");
    params.frame = read_frame(fields);
    if (fields.optional("tan_x") != nullptr || fields.optional("fov_x_deg") != nullptr)
        params.window = read_tangents(fields);
    params.start_depth = fields.number_or("start_depth", 0);
    fields.refuse_others();
    params.emission = read_emission(parent, params.window ? "pinhole" : "isotropic");
    params.radius = parent.number_or("radius", 0);
    return RadialDistribution(params);
}

/// The parts of an area that is written out in full, checked as the makers would.
InfluenceArea
complete(JsonFields& fields, std::string name, Region region, Distribution distribution) {
    InfluenceArea area{
        std::move(name),
        region,
        std::move(distribution),
        fields.number_or("density", 1),
        read_affinity(fields)
    };
    if (!(area.density > 0)) fields.refuse("'density' is not above 0");
    if (!(area.affinity.angle_deg >= 0 && area.affinity.angle_deg <= 90))
        fields.refuse("'angle_deg' is not in [0, 90]");
    if (area.affinity.distance && *area.affinity.distance < 0)
        fields.refuse("'distance' is below 0");
    return area;
}

InfluenceArea read_parallel(JsonFields& fields, std::string name, const Aabb& bounds) {
    if (const Json* window = fields.optional("window")) {
        const ParallelDistribution distribution = read_window(*window, fields);
        return complete(
            fields, std::move(name), read_region(fields.required("region"), fields), distribution
        );
    }
    const Vec3d direction = fields.vector("direction");
    const Json* region = fields.optional("region");
    return InfluenceArea::parallel(
        std::move(name),
        {direction,
         region != nullptr ? read_region(*region, fields) : Region(obb_around(bounds, direction)),
         fields.number_or("cone_half_angle_deg", 0),
         fields.number_or("density", 1),
         read_affinity(fields)}
    );
}

InfluenceArea read_radial(JsonFields& fields, std::string name, const Aabb& bounds) {
    if (const Json* view = fields.optional("view")) {
        const RadialDistribution distribution = read_view(*view, fields);
        return complete(
            fields, std::move(name), read_region(fields.required("region"), fields), distribution
        );
    }
    const Json* region = fields.optional("region");
    return InfluenceArea::radial(
        std::move(name),
        {fields.vector("apex"),
         region != nullptr ? read_region(*region, fields) : Region(bounds),
         read_emission(fields, "isotropic"),
         fields.number_or("radius", 0),
         fields.number_or("density", 1),
         read_affinity(fields)}
    );
}

InfluenceArea read_plane(JsonFields& fields, std::string name) {
    return InfluenceArea::plane(
        std::move(name),
        {fields.vector("point"),
         fields.vector("normal"),
         fields.number("half_width"),
         fields.number("half_height"),
         fields.number("depth"),
         fields.number_or("density", 1),
         read_affinity(fields)}
    );
}

InfluenceArea read_point(JsonFields& fields, std::string name) {
    return InfluenceArea::point(
        std::move(name),
        {fields.vector("eye"),
         fields.vector("direction"),
         fields.number("fov_x_deg"),
         fields.number("fov_y_deg"),
         fields.number_or("near", 0),
         fields.number("far"),
         read_emission(fields, "pinhole"),
         fields.number_or("density", 1),
         read_affinity(fields)}
    );
}

InfluenceArea read_measured(JsonFields& fields, std::string name, const Aabb& bounds) {
    const std::filesystem::path document = fields.path();
    MeasuredArea area;
    area.rays.rays =
        load_recorded_rays(resolve_inside(document.parent_path(), fields.text("rays"), document));
    area.rays.bounds = bounds;
    if (const Json* box = fields.optional("bounds")) {
        JsonFields corners(*box, fields.path(), fields.context() + ", bounds");
        area.rays.bounds = read_box(corners);
        corners.refuse_others();
    }
    area.rays.shrinkage = fields.number_or("shrinkage", area.rays.shrinkage);
    if (const Json* region = fields.optional("region")) area.region = read_region(*region, fields);
    area.density = fields.number_or("density", area.density);
    area.affinity = read_affinity(fields);
    return InfluenceArea::measured(std::move(name), std::move(area));
}

InfluenceArea read_uniform(JsonFields& fields, std::string name, const Aabb& bounds) {
    Aabb lines = bounds;
    if (const Json* box = fields.optional("bounds")) {
        JsonFields corners(*box, fields.path(), fields.context() + ", bounds");
        lines = read_box(corners);
        corners.refuse_others();
    }
    const Json* region = fields.optional("region");
    return complete(
        fields,
        std::move(name),
        region != nullptr ? read_region(*region, fields) : Region(bounds),
        UniformDistribution(lines)
    );
}

InfluenceArea
read_area(const Json& json, const std::string& path, std::size_t index, const Aabb& bounds) {
    JsonFields unnamed(json, path, "area " + std::to_string(index));
    const std::string name = unnamed.text("name");
    JsonFields fields(json, path, "area '" + name + "'");
    (void)fields.text("name");
    const std::string kind = fields.text("kind");
    const auto read = [&]() -> InfluenceArea {
        if (kind == "parallel") return read_parallel(fields, name, bounds);
        if (kind == "radial") return read_radial(fields, name, bounds);
        if (kind == "plane") return read_plane(fields, name);
        if (kind == "point") return read_point(fields, name);
        if (kind == "measured") return read_measured(fields, name, bounds);
        if (kind == "uniform") return read_uniform(fields, name, bounds);
        fields.refuse(
            "kind '" + kind + "' is not parallel, radial, plane, point, measured or uniform"
        );
    };
    try {
        InfluenceArea area = read();
        fields.refuse_others();
        return area;
    } catch (const Error& error) {
        // The makers know the area but not the file.
        if (error.path().empty()) throw Error(path, nowhere(), error.what());
        throw;
    }
}

} // namespace

std::vector<InfluenceArea> load_areas(const std::filesystem::path& path, const Aabb& scene_bounds) {
    const std::string name = path.string();
    const Json document = io_detail::parse_json(read_file(path, size_limit), path);
    JsonFields fields(document, name, "");
    if (fields.number("schema_version") != area_file_schema_version)
        fields.refuse("schema_version is not " + std::to_string(area_file_schema_version));
    const Json& list = fields.required("areas");
    if (!list.is_array()) fields.refuse("'areas' is not a list");
    fields.refuse_others();

    std::vector<InfluenceArea> areas;
    std::set<std::string> names;
    for (const Json& json : list) {
        areas.push_back(read_area(json, name, areas.size() + 1, scene_bounds));
        if (!names.insert(areas.back().name).second)
            fields.refuse("two areas are named '" + areas.back().name + "'");
    }
    return areas;
}

} // namespace raywise
