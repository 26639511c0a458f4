#include <raywise/analysis/ray_workload.hpp>

#include "analysis/workload/emitter.hpp"
#include "analysis/workload/eye.hpp"
#include "analysis/workload/path_tracer.hpp"
#include "analysis/workload/place.hpp"

#include <raywise/analysis/exact_oracle.hpp>
#include <raywise/analysis/ray_class.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/scene/scene.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raywise {

namespace {

using workload_detail::area_name;
using workload_detail::Emitter;
using workload_detail::Eye;
using workload_detail::make_eye;
using workload_detail::Paths;
using workload_detail::PathTracer;
using workload_detail::Place;
using workload_detail::place_of;
using workload_detail::SurfacePoint;
using workload_detail::view_of;

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
