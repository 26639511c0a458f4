// Triangles per second of the binned build by surface area, on one and two threads:
// bench_build_binned [benchmark options] [scene file...]; generated scenes when none is named.
#include <raywise/build/binned.hpp>

#include <raywise/bvh/validate.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/io/load_scene.hpp>
#include <raywise/scene/generate.hpp>

#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>
#include <vector>

namespace {

using namespace raywise;

std::vector<Aabb> boxes_of(const Scene& scene) {
    const TriangleView triangles = scene.view();
    std::vector<Aabb> boxes;
    boxes.reserve(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
        boxes.push_back(bounds(triangles[to_prim(i)]));
    return boxes;
}

void time_build(benchmark::State& state, const std::vector<Aabb>& boxes) {
    const Executor executor(static_cast<int>(state.range(0)));
    validate(build_binned(boxes, SurfaceMeasure{}, {}, executor), boxes);
    for (auto step : state)
        benchmark::DoNotOptimize(build_binned(boxes, SurfaceMeasure{}, {}, executor));
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(boxes.size()));
}

void add(const Scene& scene) {
    benchmark::RegisterBenchmark(
        ("build_binned/" + scene.name).c_str(),
        [boxes = boxes_of(scene)](benchmark::State& state) { time_build(state, boxes); }
    )
        ->ArgName("threads")
        ->Arg(1)
        ->Arg(2)
        ->UseRealTime()
        ->MeasureProcessCPUTime()
        ->Unit(benchmark::kMillisecond);
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
