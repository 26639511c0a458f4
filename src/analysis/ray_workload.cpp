#include <raywise/analysis/ray_workload.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/pencil/pencil.hpp>
#include <raywise/toplevel/open_place.hpp>
#include <raywise/toplevel/pencil_of.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace raywise {

namespace {

constexpr std::array classes_in_order = {
    RayClass::primary,
    RayClass::sun,
    RayClass::point_light,
    RayClass::sun_disc_027,
    RayClass::sun_disc_2,
    RayClass::area_light,
    RayClass::thin_lens,
    RayClass::diffuse_bounce,
};

constexpr double degree = std::numbers::pi / 180;
constexpr double half_field_of_view = std::numbers::inv_sqrt3; // tangent of 30 degrees
constexpr std::uint64_t image_tiles = 64;                      // per side
constexpr std::uint64_t tile_pixels = 16;                      // per side
constexpr std::size_t tile_paths = tile_pixels * tile_pixels;
constexpr std::size_t rays_per_chunk = tile_paths * 16;

// Streams of random numbers that must not meet.
enum class Stream : std::uint64_t { eye = 1, sun, lamp, tile, pixel, bounce, light, lens };

std::uint64_t seed_of(std::uint64_t seed, Stream stream, std::size_t number = 0) {
    return mix_bits(seed * 0x100 + static_cast<std::uint64_t>(stream)) + number;
}

double disc_half_angle_deg(RayClass rays) {
    return rays == RayClass::sun_disc_027 ? 0.27 : rays == RayClass::sun_disc_2 ? 2.0 : 0.0;
}

bool is_sun(RayClass rays) {
    return rays == RayClass::sun || rays == RayClass::sun_disc_027 || rays == RayClass::sun_disc_2;
}

bool is_camera(RayClass rays) {
    return rays == RayClass::primary || rays == RayClass::thin_lens;
}

int likely_up(Vec3 size) {
    constexpr float clearly = 0.875F;
    const float least = std::min({size.x, size.y, size.z});
    if (least >= clearly * size.y) return 1;
    if (least >= clearly * size.z) return 2;
    return least == size.x ? 0 : least == size.y ? 1 : 2;
}

/// Rays start at floats: an emitter between them would not lie on its own rays.
Vec3d as_origin(Vec3d point) {
    return to_double(to_float(point));
}

/// Where things are, and how large.
struct Place {
    const Scene* scene = nullptr;
    Aabb box;  ///< a little wider than the scene
    Frame sky; ///< forward is up
    Vec3d middle;
    double diagonal = 0;
};

Place place_of(const Scene& scene, const WorkloadParams& params) {
    const Aabb box = bounds(scene);
    Place place;
    place.scene = &scene;
    place.diagonal = length(to_double(box.hi) - to_double(box.lo));
    if (!(place.diagonal > 0)) throw Error("ray workload: the scene has no extent");
    // Wider than what rounding does to a hit point on its border.
    const auto pad = static_cast<float>(1e-3 * place.diagonal);
    place.box = {box.lo - Vec3{pad, pad, pad}, box.hi + Vec3{pad, pad, pad}};
    place.middle = to_double(box.center());
    Vec3d up;
    up[params.up_axis.value_or(likely_up(box.size()))] = 1;
    place.sky = frame_along(up);
    return place;
}

/// The direction at an elevation above the horizon.
Vec3d toward_sky(const Place& place, double azimuth, double elevation) {
    return from_frame(
        place.sky,
        {std::cos(elevation) * std::cos(azimuth),
         std::cos(elevation) * std::sin(azimuth),
         std::sin(elevation)}
    );
}

bool is_outside(std::size_t number) {
    return number % 2 == 0;
}

/// A place for an eye or a lamp.
Vec3d standpoint(const Place& place, std::uint64_t seed, std::size_t number) {
    Rng rng(seed, number);
    if (!is_outside(number))
        return as_origin(find_open_place(place.scene->view(), place.box, rng.bits()));
    const double azimuth = rng.uniform(0, 2 * std::numbers::pi);
    const double height = rng.uniform(0.1, 0.9); // sine of the elevation: uniform on the sphere
    return as_origin(
        place.middle + toward_sky(place, azimuth, std::asin(height)) * (0.75 * place.diagonal)
    );
}

Vec3d sun_direction(const Place& place, std::uint64_t seed, std::size_t number) {
    Rng rng(seed_of(seed, Stream::sun), number);
    const double azimuth = rng.uniform(0, 2 * std::numbers::pi);
    const double elevation = is_outside(number) ? rng.uniform(50 * degree, 80 * degree)
                                                : rng.uniform(8 * degree, 30 * degree);
    return -toward_sky(place, azimuth, elevation);
}

struct Eye {
    Vec3d position;
    Frame frame;
    double focus = 0; ///< depth at which a lens is sharp
};

Eye make_eye(const Place& place, std::uint64_t seed, std::size_t number) {
    Eye eye;
    eye.position = standpoint(place, seed_of(seed, Stream::eye), number);
    if (is_outside(number)) {
        eye.frame = frame_along(place.middle - eye.position);
        eye.focus = length(place.middle - eye.position);
    } else {
        Rng rng(seed_of(seed, Stream::eye, 1), number);
        const double azimuth = rng.uniform(0, 2 * std::numbers::pi);
        eye.frame = frame_along(toward_sky(place, azimuth, rng.uniform(-15 * degree, 15 * degree)));
        eye.focus = place.diagonal / 4;
    }
    return eye;
}

Frustum view_of(const Place& place, const Eye& eye) {
    double far = 0;
    for (int i = 0; i < 8; ++i)
        far = std::max(far, dot(to_double(place.box.vertex(i)) - eye.position, eye.frame.forward));
    return {
        .eye = eye.position,
        .frame = eye.frame,
        .tan_x = half_field_of_view,
        .tan_y = half_field_of_view,
        .far = std::max(far, 1e-3 * place.diagonal)
    };
}

/// The way into the picture that a path takes, depth 1.
Vec3d look_along(const Eye& eye, std::uint64_t tile, std::size_t pixel, Rng& rng) {
    constexpr double side = image_tiles * tile_pixels;
    const auto column = (tile % image_tiles) * tile_pixels + pixel % tile_pixels;
    const auto line = (tile / image_tiles) * tile_pixels + pixel / tile_pixels;
    const double x = (static_cast<double>(column) + rng.uniform_double()) / side * 2 - 1;
    const double y = (static_cast<double>(line) + rng.uniform_double()) / side * 2 - 1;
    return eye.frame.forward + eye.frame.right * (x * half_field_of_view) -
           eye.frame.up * (y * half_field_of_view);
}

/// A point of a path on a surface, and the side that the path sees.
struct SurfacePoint {
    bool is_there = false;
    Vec3 point;
    Vec3d normal; ///< unit, toward where the path came from
};

SurfacePoint surface_point(const Scene& scene, const Ray& ray, const Hit& hit) {
    if (hit.prim == no_prim) return {};
    const Triangle triangle = scene.view()[hit.prim];
    const Vec3d a = to_double(triangle.v0);
    const Vec3d normal = cross(to_double(triangle.v1) - a, to_double(triangle.v2) - a);
    const double size = length(normal);
    if (!(size > 0)) return {};
    const Vec3d direction = to_double(ray.direction);
    const Vec3d point = to_double(ray.origin) + direction * static_cast<double>(hit.t);
    const double side = dot(normal, direction) > 0 ? -1 : 1;
    return {true, to_float(point), normal * (side / size)};
}

/// What the paths of one eye met.
struct Paths {
    std::vector<Ray> primary;
    std::vector<Ray> bounce; ///< invalid (zero direction) where the primary ray met nothing
    std::vector<SurfacePoint> first;
    std::vector<SurfacePoint> second;
};

/// Cosine-weighted about the normal.
Vec3 diffuse_direction(Vec3d normal, Rng& rng) {
    const Vec3d direction = normal + sample_sphere(rng);
    const double size = length(direction);
    return to_float(size > 1e-6 ? direction / size : normal);
}

class PathTracer {
public:
    PathTracer(
        const Place& place,
        const ExactOracle& oracle,
        const WorkloadParams& params,
        const Executor& executor
    )
        : place_(place), oracle_(oracle), params_(params), executor_(executor) {}

    [[nodiscard]] float offset() const {
        return static_cast<float>(params_.offset * place_.diagonal);
    }

    [[nodiscard]] Paths trace(const Eye& eye, std::size_t number, std::size_t count) const {
        Paths paths;
        paths.primary = primary_rays(eye, number, count);
        paths.first = surface_points(paths.primary);
        paths.bounce.resize(count);
        for_each(count, [&](std::size_t i) {
            if (!paths.first[i].is_there) return;
            Rng rng(seed_of(params_.seed, Stream::bounce, number), i);
            paths.bounce[i] = {
                .origin = paths.first[i].point,
                .direction = diffuse_direction(paths.first[i].normal, rng),
                .t_min = offset()
            };
        });
        paths.second = surface_points(paths.bounce);
        return paths;
    }

    /// Through points of the lens and the pixels of the paths.
    [[nodiscard]] std::vector<Ray>
    lens_rays(const Eye& eye, std::size_t number, std::size_t count, double radius) const {
        std::vector<Ray> rays = primary_rays(eye, number, count);
        for_each(count, [&](std::size_t i) {
            Rng rng(seed_of(params_.seed, Stream::lens, number), i);
            const Vec2d shift = sample_disk(radius, rng);
            const Vec3d sharp = to_double(rays[i].direction) * eye.focus;
            const Vec3d on_lens = eye.frame.right * shift.x + eye.frame.up * shift.y;
            rays[i].origin = to_float(eye.position + on_lens);
            rays[i].direction = to_float(normalized(sharp - on_lens));
        });
        return rays;
    }

    template <class Work>
    void for_each(std::size_t count, const Work& work) const {
        executor_.for_each_chunk(count, rays_per_chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                work(i);
        });
    }

private:
    /// Tiles lie evenly over the picture, each at a random place in its share.
    [[nodiscard]] std::vector<Ray>
    primary_rays(const Eye& eye, std::size_t number, std::size_t count) const {
        const std::size_t tiles = (count + tile_paths - 1) / tile_paths;
        std::vector<Ray> rays(count);
        for_each(count, [&](std::size_t i) {
            const std::size_t at = i / tile_paths;
            Rng tile_rng(seed_of(params_.seed, Stream::tile, number), at);
            const double share =
                (static_cast<double>(at) + tile_rng.uniform_double()) / static_cast<double>(tiles);
            const auto tile =
                static_cast<std::uint64_t>(share * static_cast<double>(image_tiles * image_tiles));
            Rng rng(seed_of(params_.seed, Stream::pixel, number), i);
            const Vec3d along =
                look_along(eye, std::min(tile, image_tiles * image_tiles - 1), i % tile_paths, rng);
            // Depth 1 along forward, so that the lens finds its focus.
            rays[i] = {.origin = to_float(eye.position), .direction = to_float(along)};
        });
        return rays;
    }

    [[nodiscard]] std::vector<SurfacePoint> surface_points(std::span<const Ray> rays) const {
        std::vector<Hit> hits(rays.size());
        oracle_.closest_hits(rays, hits, executor_);
        std::vector<SurfacePoint> points(rays.size());
        for_each(rays.size(), [&](std::size_t i) {
            points[i] = surface_point(*place_.scene, rays[i], hits[i]);
        });
        return points;
    }

    const Place& place_;
    const ExactOracle& oracle_;
    const WorkloadParams& params_;
    const Executor& executor_;
};

std::string area_name(RayClass rays, std::size_t number) {
    return std::string(name_of(rays)) + " " + std::to_string(number + 1);
}

/// The area of a sun or a lamp.
InfluenceArea
emitter_area(const Place& place, RayClass rays, std::uint64_t seed, std::size_t number) {
    if (is_sun(rays)) {
        const Vec3d direction = sun_direction(place, seed, number);
        return InfluenceArea::parallel(
            area_name(rays, number),
            {.direction = direction,
             .region = obb_around(place.box, direction),
             .cone_half_angle_deg = disc_half_angle_deg(rays)}
        );
    }
    const bool is_point = kind_of(rays) == RayKind::exact;
    const double radius = is_point ? 0 : 0.01 * place.diagonal;
    RadialArea lamp{
        .apex = standpoint(place, seed_of(seed, Stream::lamp), number),
        .region = place.box,
        .radius = radius
    };
    if (!is_point) lamp.affinity.distance = 1.01 * radius;
    return InfluenceArea::radial(area_name(rays, number), lamp);
}

/// The shadow rays of one sun or lamp.
class Emitter {
public:
    Emitter(const Place& place, RayClass rays, std::uint64_t seed, std::size_t number)
        : rays_(rays)
        , seed_(seed_of(seed, Stream::light, static_cast<std::size_t>(rays) * 64 + number))
        , area_(emitter_area(place, rays, seed, number))
        , pencil_(central_pencil_of(area_).value()) {
        if (const auto* radial = std::get_if<RadialDistribution>(&area_.distribution)) {
            radius_ = radial->params().radius;
        } else {
            sky_ = frame_along(-to_double(pencil_.direction()));
        }
    }

    [[nodiscard]] const InfluenceArea& area() const { return area_; }

    /// From a point to the emitter; not valid where the surface faces away. `draw` numbers the rays
    /// of this emitter.
    [[nodiscard]] Ray shadow_ray(const SurfacePoint& from, float offset, std::uint64_t draw) const {
        Ray ray = unbounded_ray(from.point, draw);
        if (!(dot(from.normal, to_double(ray.direction)) > 0)) return {};
        ray.t_min =
            static_cast<float>(static_cast<double>(offset) / length(to_double(ray.direction)));
        return ray;
    }

private:
    [[nodiscard]] Ray unbounded_ray(Vec3 point, std::uint64_t draw) const {
        Rng rng(seed_, draw);
        if (kind_of(rays_) == RayKind::exact) return pencil_.shadow_ray(point);
        if (is_sun(rays_))
            return {
                .origin = point,
                .direction = to_float(sample_cap(sky_, disc_half_angle_deg(rays_) * degree, rng))
            };
        const Vec3d on_sphere = sample_sphere(rng);
        const Vec3d lamp =
            to_double(pencil_.apex()) + on_sphere * (radius_ * std::cbrt(rng.uniform_double()));
        return Pencil::radial(to_float(lamp)).shadow_ray(point);
    }

    RayClass rays_;
    std::uint64_t seed_;
    InfluenceArea area_;
    Pencil pencil_;
    Frame sky_; ///< forward is toward a sun
    double radius_ = 0;
};

/// Makes the classes one after the other out of the same eyes and paths.
class WorkloadMaker {
public:
    WorkloadMaker(
        const Scene& scene,
        const ExactOracle& oracle,
        const WorkloadParams& params,
        const Executor& executor
    )
        : place_(place_of(scene, params))
        , params_(params)
        , tracer_(place_, oracle, params_, executor) {
        for (std::size_t e = 0; e < emitters(); ++e) {
            eyes_.push_back(make_eye(place_, params.seed, e));
            paths_.push_back(tracer_.trace(eyes_[e], e, paths_per_eye()));
        }
    }

    [[nodiscard]] Workload make(std::span<const RayClass> classes) const {
        Workload workload;
        workload.offset = static_cast<double>(tracer_.offset());
        for (const RayClass rays : classes) {
            ClassRays& made = workload.classes.emplace_back();
            made.rays = rays;
            if (rays == RayClass::diffuse_bounce) {
                made.emitters.push_back(bounces());
                continue;
            }
            for (std::size_t e = 0; e < emitters(); ++e)
                made.emitters.push_back(
                    is_camera(rays) ? seen_by_camera(rays, e, workload)
                                    : shadowed_by_emitter(rays, e, workload)
                );
        }
        return workload;
    }

private:
    [[nodiscard]] std::size_t emitters() const {
        return static_cast<std::size_t>(params_.emitters);
    }

    [[nodiscard]] std::size_t paths_per_eye() const {
        return std::max<std::size_t>(1, params_.paths / emitters());
    }

    [[nodiscard]] EmitterRays bounces() const {
        EmitterRays result;
        for (const Paths& paths : paths_)
            for (const Ray& ray : paths.bounce)
                if (is_valid(ray)) result.rays.push_back(ray);
        return result;
    }

    [[nodiscard]] EmitterRays
    seen_by_camera(RayClass rays, std::size_t number, Workload& workload) const {
        const Eye& eye = eyes_[number];
        const Frustum view = view_of(place_, eye);
        const std::string name = area_name(rays, number);
        if (rays == RayClass::primary) {
            workload.areas.push_back(InfluenceArea::radial(
                name, {.apex = eye.position, .region = view, .emission = Emission::pinhole}
            ));
            return {name, paths_[number].primary};
        }
        const double radius = 1e-3 * place_.diagonal;
        // Wide enough for the whole lens; the apex is then inside, where a pinhole may not be.
        workload.areas.push_back(InfluenceArea::radial(
            name,
            {.apex = eye.position,
             .region = inflated(view, 1.01 * radius),
             .radius = radius,
             .affinity = {.distance = 1.01 * radius}}
        ));
        return {name, tracer_.lens_rays(eye, number, paths_per_eye(), radius)};
    }

    [[nodiscard]] EmitterRays
    shadowed_by_emitter(RayClass rays, std::size_t number, Workload& workload) const {
        const Emitter emitter(place_, rays, params_.seed, number);
        EmitterRays result{emitter.area().name, {}};
        std::uint64_t draw = 0;
        const auto add = [&](const SurfacePoint& from) {
            if (!from.is_there) return;
            const Ray ray = emitter.shadow_ray(from, tracer_.offset(), draw++);
            if (is_valid(ray)) result.rays.push_back(ray);
        };
        for (const Paths& paths : paths_) {
            for (std::size_t i = 0; i < paths.primary.size(); ++i) {
                add(paths.first[i]);
                add(paths.second[i]);
            }
        }
        workload.areas.push_back(emitter.area());
        return result;
    }

    Place place_;
    WorkloadParams params_;
    PathTracer tracer_;
    std::vector<Eye> eyes_;
    std::vector<Paths> paths_;
};

void check(const Scene& scene, const WorkloadParams& params) {
    if (scene.triangles.empty()) throw Error("ray workload: the scene has no triangles");
    if (params.paths < 1 || params.paths > 100'000'000)
        throw Error("ray workload: paths must be in [1, 10^8]");
    if (params.emitters < 1 || params.emitters > 64)
        throw Error("ray workload: emitters must be in [1, 64]");
    if (params.up_axis && (*params.up_axis < 0 || *params.up_axis > 2))
        throw Error("ray workload: up_axis must be 0, 1 or 2");
    if (!(params.offset >= 0 && params.offset <= 1))
        throw Error("ray workload: offset must be in [0, 1]");
}

} // namespace

std::span<const RayClass> all_ray_classes() {
    return classes_in_order;
}

std::string_view name_of(RayClass rays) {
    switch (rays) {
    case RayClass::primary:
        return "primary";
    case RayClass::sun:
        return "sun";
    case RayClass::point_light:
        return "point_light";
    case RayClass::sun_disc_027:
        return "sun_disc_0.27";
    case RayClass::sun_disc_2:
        return "sun_disc_2";
    case RayClass::area_light:
        return "area_light";
    case RayClass::thin_lens:
        return "thin_lens";
    case RayClass::diffuse_bounce:
        break;
    }
    return "diffuse_bounce";
}

std::string_view name_of(RayKind kind) {
    switch (kind) {
    case RayKind::exact:
        return "exact";
    case RayKind::near_affine:
        return "near_affine";
    case RayKind::general:
        break;
    }
    return "general";
}

RayKind kind_of(RayClass rays) {
    switch (rays) {
    case RayClass::primary:
    case RayClass::sun:
    case RayClass::point_light:
        return RayKind::exact;
    case RayClass::diffuse_bounce:
        return RayKind::general;
    default:
        return RayKind::near_affine;
    }
}

bool asks_closest(RayClass rays) {
    return is_camera(rays) || rays == RayClass::diffuse_bounce;
}

std::size_t ClassRays::count() const {
    std::size_t sum = 0;
    for (const EmitterRays& of_emitter : emitters)
        sum += of_emitter.rays.size();
    return sum;
}

Workload make_workload(
    const Scene& scene,
    const ExactOracle& oracle,
    std::span<const RayClass> classes,
    const WorkloadParams& params,
    const Executor& executor
) {
    check(scene, params);
    return WorkloadMaker(scene, oracle, params, executor).make(classes);
}

} // namespace raywise
