#include <raywise/toplevel/propose_areas.hpp>

#include <raywise/core/error.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/open_place.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace raywise {
namespace {

constexpr double widest_spot_rad = 75 * std::numbers::pi / 180;

/// The scene's box, wider by the margin, and by a unit where the scene is a single point.
Aabb wide_bounds(const Scene& scene, double margin) {
    const Aabb box = bounds(scene);
    const double diagonal = length(to_double(box.hi) - to_double(box.lo));
    // A flat scene has a region of some depth: a region without a shadow has no rays.
    const double least = diagonal > 0 ? 1e-6 * diagonal : 1;
    const auto pad = static_cast<float>(std::max(margin * diagonal, least));
    Aabb wide{box.lo - Vec3{pad, pad, pad}, box.hi + Vec3{pad, pad, pad}};
    // Far from the origin the pad may have been lost in the rounding.
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        wide.lo[axis] = std::min(wide.lo[axis], std::nextafter(box.lo[axis], -infinity));
        wide.hi[axis] = std::max(wide.hi[axis], std::nextafter(box.hi[axis], infinity));
    }
    return wide;
}

/// Ray origins are floats: an eye between them would lie outside its own frustum's apex. Written
/// through memory: g++ 12 takes two neighboring conversions to float and back for nothing at -O2.
Vec3d as_origin(Vec3d eye) {
    volatile auto x = static_cast<float>(eye.x);
    volatile auto y = static_cast<float>(eye.y);
    volatile auto z = static_cast<float>(eye.z);
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
}

/// Lets parallel rays start `depth` inside their region: on its border the rounding of an origin
/// puts every other ray outside.
InfluenceArea started_at(InfluenceArea area, double depth) {
    ParallelParams params = std::get<ParallelDistribution>(area.distribution).params();
    params.start_depth = depth;
    area.distribution = ParallelDistribution(params);
    return area;
}

/// Distance along `forward` from `eye` to the farthest corner of the box.
double far_end(const Aabb& box, Vec3d eye, Vec3d forward) {
    double far = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < 8; ++i) {
        far = std::max(far, dot(to_double(box.vertex(i)) - eye, forward));
    }
    return far;
}

double distance_to(const Aabb& box, Vec3d point) {
    const Vec3d zero;
    const Vec3d below = max(to_double(box.lo) - point, zero);
    const Vec3d above = max(point - to_double(box.hi), zero);
    return length(below + above);
}

/// Collects areas under names that differ.
class Proposal {
public:
    explicit Proposal(const Aabb& box) : box_(box) {}

    void add_sun(const std::string& name, Vec3d direction) {
        const Obb region = obb_around(box_, direction);
        add(name, [&](std::string unique) {
            return started_at(
                InfluenceArea::parallel(
                    std::move(unique), {.direction = direction, .region = region}
                ),
                1e-4 * region.half.z
            );
        });
    }

    void add_lamp(const std::string& name, Vec3d position, double range) {
        const Vec3d apex = as_origin(position);
        if (!(distance_to(box_, apex) < range)) return;
        Aabb region = box_;
        if (std::isfinite(range)) {
            const Vec3d reach{range, range, range};
            region = intersect(region, {to_float(apex - reach), to_float(apex + reach)});
        }
        if (region.is_empty()) return;
        add(name, [&](std::string unique) {
            return InfluenceArea::radial(std::move(unique), {.apex = apex, .region = region});
        });
    }

    void add_spot(const std::string& name, const Light& light) {
        const Frustum cone{
            .eye = as_origin(light.position),
            .frame = frame_along(light.direction),
            .tan_x = std::tan(light.cone_rad),
            .tan_y = std::tan(light.cone_rad)
        };
        add_frustum(name, cone, light.range, Emission::isotropic);
    }

    void add_camera(const std::string& name, const Camera& camera) {
        if (camera.projection == Projection::perspective) {
            const Frustum view{
                .eye = as_origin(camera.eye),
                .frame = camera.frame,
                .tan_x = std::tan(camera.fov_x_rad / 2),
                .tan_y = std::tan(camera.fov_y_rad / 2)
            };
            add_frustum(name, view, camera.far, Emission::pinhole);
            return;
        }
        const Vec3d forward = camera.frame.forward;
        const double far = std::min(camera.far, far_end(box_, camera.eye, forward));
        if (!(far > camera.near)) return;
        // The region begins behind the near plane, on which the rays start.
        const double behind = 1e-3 * (far - camera.near);
        const double near = camera.near - behind;
        const Obb view{
            .center = camera.eye + forward * ((near + far) / 2),
            .frame = camera.frame,
            .half = {camera.half_width, camera.half_height, (far - near) / 2}
        };
        add(name, [&](std::string unique) {
            return started_at(
                InfluenceArea::parallel(std::move(unique), {.direction = forward, .region = view}),
                behind
            );
        });
    }

    [[nodiscard]] std::vector<InfluenceArea> take() { return std::move(areas_); }

private:
    /// The pyramid from its apex to the scene's far end, unless the scene lies behind it.
    void add_frustum(const std::string& name, Frustum region, double reach, Emission emission) {
        region.near = 0;
        region.far = std::min(reach, far_end(box_, region.eye, region.frame.forward));
        if (!(region.far > 0) || !(distance_to(box_, region.eye) < reach)) return;
        add(name, [&](std::string unique) {
            return InfluenceArea::radial(
                std::move(unique), {.apex = region.eye, .region = region, .emission = emission}
            );
        });
    }

    template <class Make>
    void add(const std::string& name, const Make& make) {
        std::string unique = name;
        for (int number = 2; !names_.insert(unique).second; ++number) {
            unique = name + " " + std::to_string(number);
        }
        areas_.push_back(make(unique));
    }

    Aabb box_;
    std::set<std::string> names_;
    std::vector<InfluenceArea> areas_;
};

void add_light(Proposal& proposal, const Light& light) {
    const std::string name = light.name.empty() ? "light" : light.name;
    if (light.kind == LightKind::directional) {
        proposal.add_sun(name, light.direction);
    } else if (light.kind == LightKind::spot && light.cone_rad <= widest_spot_rad) {
        proposal.add_spot(name, light);
    } else {
        proposal.add_lamp(name, light.position, light.range);
    }
}

void add_defaults(
    Proposal& proposal,
    const Scene& scene,
    const Aabb& box,
    const ProposeParams& params
) {
    const Frame upright = frame_along(params.up); // forward is up
    const Vec3d side = upright.right;
    const Vec3d ahead = upright.up;
    proposal.add_sun("sun", from_frame(upright, {0.35, 0.5, -0.8}));

    proposal.add_lamp(
        "lamp",
        find_open_place(scene.view(), box, params.seed),
        std::numeric_limits<double>::infinity()
    );

    // The whole bounding sphere fits a view of 60 degrees from twice its radius away.
    const Vec3d middle = to_double(box.center());
    const double radius = length(to_double(box.hi) - to_double(box.lo)) / 2;
    const Vec3d look = normalized(side * -0.6 + ahead * -0.65 + upright.forward * -0.45);
    constexpr double sixty_degrees = std::numbers::pi / 3;
    Camera camera;
    camera.eye = middle - look * (2.05 * radius);
    camera.frame = frame_along(look);
    camera.fov_x_rad = sixty_degrees;
    camera.fov_y_rad = sixty_degrees;
    proposal.add_camera("camera", camera);
}

} // namespace

std::vector<InfluenceArea> propose_areas(const Scene& scene, const ProposeParams& params) {
    if (!is_finite(params.up) || params.up == Vec3d{}) {
        throw Error("propose areas: up must be finite and not zero");
    }
    if (!(params.margin >= 0 && params.margin <= 1)) {
        throw Error("propose areas: margin must be in [0, 1]");
    }
    if (scene.triangles.empty()) return {};
    const Aabb box = wide_bounds(scene, params.margin);
    Proposal proposal(box);
    if (scene.lights.empty() && scene.cameras.empty()) {
        add_defaults(proposal, scene, box, params);
        return proposal.take();
    }
    for (const Light& light : scene.lights)
        add_light(proposal, light);
    for (const Camera& camera : scene.cameras) {
        proposal.add_camera(camera.name.empty() ? "camera" : camera.name, camera);
    }
    return proposal.take();
}

} // namespace raywise
