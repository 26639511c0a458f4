#include <raywise/io/area_file.hpp>

#include "io/json_fields.hpp"

#include <raywise/core/error.hpp>
#include <raywise/io/files.hpp>
#include <raywise/io/ray_file.hpp>

#include <numbers>
#include <set>
#include <string>
#include <utility>

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

Frame read_frame(JsonFields& fields) {
    const Vec3d direction = fields.vector("direction");
    return frame_along(direction, radians(fields.number_or("roll_deg", 0)));
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
    const RadialWindow window =
        window_of_fov(fields.number("fov_x_deg"), fields.number("fov_y_deg"));
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

InfluenceArea read_parallel(JsonFields& fields, std::string name, const Aabb& bounds) {
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
    const std::vector<Ray> rays =
        load_rays(resolve_inside(document.parent_path(), fields.text("rays"), document));
    MeasuredArea area;
    area.rays.bounds = bounds;
    area.rays.shrinkage = fields.number_or("shrinkage", area.rays.shrinkage);
    area.rays.rays.reserve(rays.size());
    for (const Ray& ray : rays)
        area.rays.rays.push_back({ray});
    if (const Json* region = fields.optional("region")) area.region = read_region(*region, fields);
    area.density = fields.number_or("density", area.density);
    area.affinity = read_affinity(fields);
    return InfluenceArea::measured(std::move(name), std::move(area));
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
        fields.refuse("kind '" + kind + "' is not parallel, radial, plane, point or measured");
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
    const Json document = detail::parse_json(read_file(path, size_limit), name);
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
