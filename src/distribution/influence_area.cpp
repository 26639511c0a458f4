#include <raywise/distribution/influence_area.hpp>

#include "distribution/angles.hpp"
#include "distribution/checks.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rounding.hpp>
#include <raywise/distribution/measured.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace raywise {

namespace {

void check_region(const Aabb& box) {
    require(
        is_finite(box.lo) && is_finite(box.hi) && !box.is_empty(),
        "the region",
        "finite and not empty"
    );
}

void check_region(const Obb& box) {
    require_finite(box.center, "the region's center");
    require_orthonormal(box.frame, "the region's frame");
    require_not_negative(box.half.x, "the region's half width");
    require_not_negative(box.half.y, "the region's half height");
    require_not_negative(box.half.z, "the region's half depth");
}

void check_region(const Frustum& frustum) {
    require_finite(frustum.eye, "the frustum's eye");
    require_orthonormal(frustum.frame, "the frustum's frame");
    require_positive(frustum.tan_x, "the frustum's horizontal tangent");
    require_positive(frustum.tan_y, "the frustum's vertical tangent");
    require_not_negative(frustum.near, "the frustum's near depth");
    require(
        std::isfinite(frustum.far) && frustum.far > frustum.near,
        "the frustum's far depth",
        "finite and above the near depth"
    );
}

std::array<Vec3d, 8> vertices_of(const Region& region) {
    struct VertexOf {
        int i;

        Vec3d operator()(const Aabb& box) const { return to_double(box.vertex(i)); }

        Vec3d operator()(const Obb& box) const { return vertex(box, i); }

        Vec3d operator()(const Frustum& frustum) const { return vertex(frustum, i); }
    };

    std::array<Vec3d, 8> vertices;
    for (int i = 0; i < 8; ++i)
        vertices[static_cast<std::size_t>(i)] = std::visit(VertexOf{i}, region);
    return vertices;
}

Frame frame_of(const Region& region) {
    if (const auto* box = std::get_if<Obb>(&region)) return box->frame;
    if (const auto* frustum = std::get_if<Frustum>(&region)) return frustum->frame;
    return {};
}

/// Bounds of points in the coordinates of a frame.
struct Extent {
    Vec3d lo;
    Vec3d hi;
};

Extent extent_of(std::span<const Vec3d> points, const Frame& frame) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Extent extent{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (const Vec3d& point : points) {
        const Vec3d at = to_frame(frame, point);
        extent.lo = min(extent.lo, at);
        extent.hi = max(extent.hi, at);
    }
    return extent;
}

/// The frame along `forward` in which the region's shadow has the smallest bounding rectangle,
/// among those that keep an axis of the region upright, and frame_along. An oriented box seen along
/// one of its axes is matched exactly.
Frame tight_frame(const Region& region, Vec3d direction) {
    const auto vertices = vertices_of(region);
    const Frame own = frame_of(region);
    Frame best = frame_along(direction);
    const auto shadow_area = [&vertices](const Frame& frame) {
        const Extent extent = extent_of(vertices, frame);
        return (extent.hi.x - extent.lo.x) * (extent.hi.y - extent.lo.y);
    };
    double best_area = shadow_area(best);
    for (const Vec3d axis : {own.right, own.up, own.forward}) {
        const Vec3d across = axis - best.forward * dot(axis, best.forward);
        constexpr double nearly_along = 1e-3;
        if (length(across) < nearly_along) continue;
        const Vec3d up = normalized(across);
        // A second pass restores the orthogonality that a short `across` has lost.
        const Vec3d upright = normalized(up - best.forward * dot(up, best.forward));
        const Frame frame{cross(upright, best.forward), upright, best.forward};
        const double area = shadow_area(frame);
        if (area < best_area) {
            best_area = area;
            best = frame;
        }
    }
    return best;
}

ParallelParams window_over(const Region& region, Vec3d direction, double cone_half_angle_deg) {
    const Frame frame = tight_frame(region, direction);
    const Extent extent = extent_of(vertices_of(region), frame);
    const Vec3d middle = (extent.lo + extent.hi) * 0.5;
    const Vec3d half = (extent.hi - extent.lo) * 0.5;
    require(
        half.x > 0 && half.y > 0, "the region's shadow along the direction", "of positive area"
    );
    return {
        .point = from_frame(frame, {middle.x, middle.y, extent.lo.z}),
        .frame = frame,
        .half_width = half.x,
        .half_height = half.y,
        .cone_half_angle_deg = cone_half_angle_deg
    };
}

/// The frame and window in which the region appears from the apex; no window when it reaches around
/// the apex (beyond 89 degrees off the direction to its middle).
std::pair<Frame, std::optional<RadialWindow>> window_from(const Region& region, Vec3d apex) {
    if (const auto* frustum = std::get_if<Frustum>(&region);
        frustum != nullptr && frustum->eye == apex)
        return {frustum->frame, RadialWindow{frustum->tan_x, frustum->tan_y}};
    const auto vertices = vertices_of(region);
    Vec3d middle;
    for (const Vec3d& at : vertices)
        middle = middle + (at - apex) * 0.125;
    if (middle == Vec3d{}) return {Frame{}, std::nullopt};
    const Frame frame = frame_along(middle);
    RadialWindow window{0, 0};
    const double widest = std::tan(to_radians(89));
    for (const Vec3d& at : vertices) {
        const Vec3d seen = to_frame(frame, at - apex);
        if (!(std::abs(seen.x) <= widest * seen.z && std::abs(seen.y) <= widest * seen.z) ||
            seen.z == 0)
            return {frame, std::nullopt};
        window.tan_x = std::max(window.tan_x, std::abs(seen.x) / seen.z);
        window.tan_y = std::max(window.tan_y, std::abs(seen.y) / seen.z);
    }
    return {frame, window};
}

void check_common(const InfluenceArea& area) {
    std::visit([](const auto& region) { check_region(region); }, area.region);
    require_positive(area.density, "the density");
    require(
        area.affinity.angle_deg >= 0 && area.affinity.angle_deg <= 90,
        "the affinity's angle",
        "in [0, 90] degrees"
    );
    if (!area.affinity.distance) return;
    require_not_negative(*area.affinity.distance, "the affinity's distance");
    require(
        std::holds_alternative<RadialDistribution>(area.distribution),
        "an area with an affinity by distance",
        "radial"
    );
}

/// Runs a maker and puts the area's name before whatever it refuses.
template <class Make>
InfluenceArea make_area(std::string name, const Make& make) {
    if (name.empty()) throw Error("an influence area must have a name");
    try {
        InfluenceArea area = make();
        check_common(area);
        area.name = std::move(name);
        return area;
    } catch (const Error& error) {
        throw Error("influence area '" + escaped(name, 100) + "': " + error.what());
    }
}

/// The oriented box around points, in a frame.
Obb enclose(std::span<const Vec3d> points, const Frame& frame) {
    const Extent extent = extent_of(points, frame);
    const Vec3d middle = (extent.lo + extent.hi) * 0.5;
    // Room for the rounding of the coordinates here and in whoever asks what the box contains.
    const double reach = length(max(abs(extent.lo), abs(extent.hi)));
    const double room = 16 * double_epsilon * reach;
    const Vec3d half = (extent.hi - extent.lo) * 0.5 + Vec3d{room, room, room};
    return {from_frame(frame, middle), frame, half};
}

Obb around_origins(const MeasuredParams& params) {
    std::vector<Vec3d> origins;
    origins.reserve(params.rays.size());
    Vec3d mean;
    for (const RecordedRay& recorded : params.rays) {
        origins.push_back(to_double(recorded.ray.origin));
        mean = mean + normalized(to_double(recorded.ray.direction)) * recorded.weight;
    }
    return enclose(origins, mean == Vec3d{} ? Frame{} : frame_along(mean));
}

} // namespace

InfluenceArea InfluenceArea::parallel(std::string name, const ParallelArea& area) {
    return make_area(std::move(name), [&area] {
        std::visit([](const auto& region) { check_region(region); }, area.region);
        return InfluenceArea{
            .name = {},
            .region = area.region,
            .distribution = ParallelDistribution(
                window_over(area.region, area.direction, area.cone_half_angle_deg)
            ),
            .density = area.density,
            .affinity = area.affinity
        };
    });
}

InfluenceArea InfluenceArea::radial(std::string name, const RadialArea& area) {
    return make_area(std::move(name), [&area] {
        std::visit([](const auto& region) { check_region(region); }, area.region);
        require_finite(area.apex, "the apex");
        const auto [frame, window] = window_from(area.region, area.apex);
        require(
            window || area.emission == Emission::isotropic,
            "the emission into a region around the apex",
            "isotropic"
        );
        return InfluenceArea{
            .name = {},
            .region = area.region,
            .distribution = RadialDistribution(
                {.eye = area.apex,
                 .frame = frame,
                 .window = window,
                 .emission = area.emission,
                 .radius = area.radius}
            ),
            .density = area.density,
            .affinity = area.affinity
        };
    });
}

InfluenceArea InfluenceArea::plane(std::string name, const PlaneArea& area) {
    return make_area(std::move(name), [&area] {
        require_positive(area.depth, "the depth");
        const Frame frame = frame_along(area.normal);
        const ParallelDistribution rays(
            {.point = area.point,
             .frame = frame,
             .half_width = area.half_width,
             .half_height = area.half_height}
        );
        const Obb region{
            area.point + frame.forward * (area.depth / 2),
            frame,
            {area.half_width, area.half_height, area.depth / 2}
        };
        return InfluenceArea{
            .name = {},
            .region = region,
            .distribution = rays,
            .density = area.density,
            .affinity = area.affinity
        };
    });
}

InfluenceArea InfluenceArea::point(std::string name, const PointArea& area) {
    return make_area(std::move(name), [&area] {
        const Frame frame = frame_along(area.direction);
        const RadialWindow window = window_of_fov(area.fov_x_deg, area.fov_y_deg);
        const RadialDistribution rays(
            {.eye = area.eye,
             .frame = frame,
             .window = window,
             .emission = area.emission,
             .start_depth = area.near}
        );
        const Frustum region{
            .eye = area.eye,
            .frame = frame,
            .tan_x = window.tan_x,
            .tan_y = window.tan_y,
            .near = area.near,
            .far = area.far
        };
        return InfluenceArea{
            .name = {},
            .region = region,
            .distribution = rays,
            .density = area.density,
            .affinity = area.affinity
        };
    });
}

InfluenceArea InfluenceArea::measured(std::string name, MeasuredArea area) {
    return make_area(std::move(name), [&area] {
        const MeasuredDistribution rays(std::move(area.rays));
        return InfluenceArea{
            .name = {},
            .region = area.region ? *area.region : Region(around_origins(rays.params())),
            .distribution = rays,
            .density = area.density,
            .affinity = area.affinity
        };
    });
}

namespace {

/// Whether the lines along `a` and `b` meet at an angle of at most `angle_rad`, in [0, pi/2];
/// precise near 0. Squares of floats' products neither overflow nor vanish in double.
bool within_angle(Vec3d a, Vec3d b, double angle_rad) {
    constexpr double rounding = 1 + 16 * double_epsilon; // so that a right angle admits every line
    const Vec3d across = cross(a, b);
    const double sine = std::sin(angle_rad) * rounding;
    return dot(across, across) <= sine * sine * dot(a, a) * dot(b, b);
}

/// Distance of the ray's line from the eye, given the vector from the eye to the ray's origin.
double line_distance(Vec3d from_eye, Vec3d direction) {
    return length(cross(from_eye, direction)) / length(direction);
}

/// By how much the rounding of float coordinates can shift a point of the ray, seen from the eye.
double rounding_of(Vec3d origin, Vec3d eye) {
    return 8 * float_epsilon * (length(origin) + length(eye));
}

bool starts_inside(const InfluenceArea& area, const Ray& ray) {
    return is_valid(ray) && contains(area.region, to_double(ray.origin));
}

} // namespace

bool is_affine(const InfluenceArea& area, const Ray& ray) {
    return starts_inside(area, ray) && follows(area, ray);
}

bool follows(const InfluenceArea& area, const Ray& ray) {
    const double tolerance = to_radians(area.affinity.angle_deg);
    const Vec3d direction = to_double(ray.direction);
    if (const auto* parallel = std::get_if<ParallelDistribution>(&area.distribution))
        return within_angle(direction, parallel->params().frame.forward, tolerance);
    if (const auto* radial = std::get_if<RadialDistribution>(&area.distribution)) {
        const Vec3d eye = radial->params().eye;
        const Vec3d from_eye = to_double(ray.origin) - eye;
        if (area.affinity.distance)
            return line_distance(from_eye, direction) <= *area.affinity.distance;
        if (length(from_eye) <= rounding_of(to_double(ray.origin), eye)) return true;
        return within_angle(direction, from_eye, tolerance);
    }
    return true;
}

bool is_exact(const InfluenceArea& area, const Ray& ray) {
    if (!starts_inside(area, ray)) return false;
    const Vec3d direction = to_double(ray.direction);
    if (const auto* parallel = std::get_if<ParallelDistribution>(&area.distribution))
        return within_angle(direction, parallel->params().frame.forward, 4 * float_epsilon);
    if (const auto* radial = std::get_if<RadialDistribution>(&area.distribution)) {
        const Vec3d origin = to_double(ray.origin);
        const Vec3d eye = radial->params().eye;
        return line_distance(origin - eye, direction) <= rounding_of(origin, eye);
    }
    return false;
}

Obb obb_around(const Aabb& bounds) {
    check_region(bounds);
    return enclose(vertices_of(bounds), Frame{});
}

Obb obb_around(const Aabb& bounds, Vec3d direction) {
    check_region(bounds);
    return enclose(vertices_of(bounds), frame_along(direction));
}

} // namespace raywise
