// How long better trees take to build, on one and two threads, and what they save, counted:
// bench_optimize_reinsertion [benchmark options] [scene file...]; generated scenes when none is
// named. Counters are means per ray over diffuse bounces that no builder has seen: cost (2 per
// inner node opened, 1.2 per triangle test), and cost for any-hit queries.
#include <raywise/optimize/reinsertion.hpp>

#include <raywise/build/binned.hpp>
#include <raywise/build/spatial.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/local_segment_measure.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/segment_measure.hpp>
#include <raywise/io/load_scene.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/closest_hit.hpp>
#include <raywise/trace/terminate.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace raywise;

constexpr std::size_t ray_count = 8192;

struct Subject {
    Scene scene;
    std::vector<Aabb> boxes;
    std::vector<Ray> seen;  ///< bounces for the measured tree, ended at their hits
    std::vector<Ray> other; ///< bounces to judge by
};

/// Where rays from eight eyes inside the scene bounce to.
std::vector<Ray> bounces(const Scene& scene, const Bvh& tree) {
    const Aabb box = bounds(scene);
    const Vec3 margin = box.size() * 0.2F;
    std::vector<Ray> rays;
    for (std::size_t i = 0; rays.size() < 2 * ray_count && i < 64 * ray_count; ++i) {
        Rng place(1, i % 8);
        Rng rng(2, i);
        const Ray ray{
            sample_box({box.lo + margin, box.hi - margin}, place), to_float(sample_sphere(rng))
        };
        const auto hit = closest_hit(tree, IndexedTriangles(scene.view()), ray);
        if (!hit) continue;
        Ray bounce{point_at(ray, hit->t), to_float(sample_sphere(rng))};
        bounce.excluded = hit->prim;
        rays.push_back(bounce);
    }
    return rays;
}

std::shared_ptr<const Subject> subject_of(Scene scene) {
    auto subject = std::make_shared<Subject>();
    subject->scene = std::move(scene);
    subject->boxes = triangle_boxes(subject->scene);
    const Bvh tree = build_binned(subject->boxes, SurfaceMeasure{});
    const std::vector<Ray> rays = bounces(subject->scene, tree);
    const std::span<const Ray> all(rays);
    const std::size_t half = all.size() / 2;
    subject->seen = terminated(
        tree, IndexedTriangles(subject->scene.view()), all.first(std::min<std::size_t>(half, 4096))
    );
    subject->other.assign(all.begin() + static_cast<std::ptrdiff_t>(half), all.end());
    return subject;
}

void count(benchmark::State& state, const Subject& subject, const Bvh& tree) {
    const IndexedTriangles triangles(subject.scene.view());
    Counts closest;
    Counts any;
    for (const Ray& ray : subject.other) {
        static_cast<void>(closest_hit(tree, triangles, ray, closest));
        static_cast<void>(any_hit(tree, triangles, ray, any));
    }
    const auto rays = static_cast<double>(subject.other.size());
    state.counters["cost"] = cost_of(closest) / rays;
    state.counters["any_cost"] = cost_of(any) / rays;
    state.counters["references"] = static_cast<double>(tree.prims.size()) /
                                   static_cast<double>(subject.scene.triangles.size());
}

using Build = std::function<Bvh(const Subject&, const Executor&)>;

void add(const std::string& name, const std::shared_ptr<const Subject>& subject, Build build) {
    benchmark::RegisterBenchmark(
        (name + "/" + subject->scene.name).c_str(),
        [subject, build = std::move(build)](benchmark::State& state) {
            const Executor executor(static_cast<int>(state.range(0)));
            Bvh tree = build(*subject, executor);
            validate(tree, subject->scene.triangles.size());
            for (auto step : state)
                benchmark::DoNotOptimize(tree = build(*subject, executor));
            count(state, *subject, tree);
        }
    )
        ->ArgName("threads")
        ->Arg(1)
        ->Arg(2)
        ->UseRealTime()
        ->MeasureProcessCPUTime()
        ->Unit(benchmark::kMillisecond);
}

void add(Scene scene) {
    const auto subject = subject_of(std::move(scene));
    add("binned", subject, [](const Subject& s, const Executor& executor) {
        return build_binned(s.boxes, SurfaceMeasure{}, {}, executor);
    });
    add("spatial", subject, [](const Subject& s, const Executor& executor) {
        return build_spatial(s.scene.view(), SurfaceMeasure{}, {}, executor);
    });
    add("reinserted", subject, [](const Subject& s, const Executor& executor) {
        const Bvh tree = build_spatial(s.scene.view(), SurfaceMeasure{}, {}, executor);
        return reinsert(tree, SurfaceMeasure{}, {}, executor);
    });
    add("measured", subject, [](const Subject& s, const Executor& executor) {
        const SegmentMeasure measure(s.seen, bounds(s.scene));
        const LocalSegmentMeasure local(measure, bounds(s.scene));
        const Bvh tree = build_spatial(s.scene.view(), local, {}, executor);
        const Bvh better = reinsert(tree, SurfaceMeasure{}, {}, executor);
        return reinsert(better, measure, {.batch = 0.02, .max_rounds = 3}, executor);
    });
}

} // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    for (int i = 1; i < argc; ++i)
        add(load_scene(argv[i]));
    if (argc < 2)
        for (const auto generate : {generate_city, generate_forest, generate_terrain})
            add(generate({.triangles = 200'000, .seed = 1}));
    benchmark::RunSpecifiedBenchmarks();
}
