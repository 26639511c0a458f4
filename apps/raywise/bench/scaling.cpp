#include "bench/class_bench.hpp"
#include "bench/rows.hpp"
#include "bench/scaling.hpp"

#include <raywise/analysis/exact_oracle.hpp>
#include <raywise/analysis/ray_class.hpp>
#include <raywise/analysis/ray_workload.hpp>
#include <raywise/analysis/side_by_side.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/pencil/pencil_grid.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/accelerator.hpp>

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace raywise::app {

namespace {

std::string name_in(const std::string& recipe) {
    return recipe.substr(0, recipe.find(':'));
}

/// Times work on one thread and on all, in turn.
class ThreadBench {
public:
    ThreadBench(std::string title, const Effort& effort, const Executor& all)
        : title_(std::move(title)), effort_(effort), all_(all) {}

    template <class Work>
    void measure(const std::string& name, const Work& work) {
        const SideBySide timed = time_side_by_side(
            [&] { work(all_); },
            [&] { work(serial_executor()); },
            {.min_rounds = 5, .budget_ms = effort_.budget_ms}
        );
        rows_.push_back(
            {title_,
             name,
             all_.threads(),
             timed.second_ns * 1e-6,
             timed.first_ns * 1e-6,
             timed.ratio,
             timed.spread}
        );
    }

    [[nodiscard]] std::vector<ThreadRow> take() { return std::move(rows_); }

private:
    std::string title_;
    const Effort& effort_;
    const Executor& all_;
    std::vector<ThreadRow> rows_;
};

} // namespace

std::vector<std::string> series_of(std::span<const std::string> names, std::size_t most) {
    std::vector<std::string> recipes;
    for (const std::string& name : names)
        for (std::size_t count = 10'000; count <= most; count *= 10)
            recipes.push_back(fmt::format("{}:{}", name, count));
    return recipes;
}

std::vector<GrowthRow> growth_of(std::span<const BenchRow> rows) {
    struct Ends {
        const BenchRow* smallest = nullptr;
        const BenchRow* largest = nullptr;
    };

    std::map<std::tuple<std::string, RayClass, Peer>, Ends> series;
    for (const BenchRow& row : rows) {
        if (row.rounds == 0 || row.scene.find(':') == std::string::npos) continue;
        Ends& ends = series[{name_in(row.scene), row.rays, row.peer}];
        if (ends.smallest == nullptr || row.triangles < ends.smallest->triangles)
            ends.smallest = &row;
        if (ends.largest == nullptr || row.triangles > ends.largest->triangles) ends.largest = &row;
    }
    std::vector<GrowthRow> growth;
    for (const auto& [key, ends] : series) {
        if (ends.smallest->triangles == ends.largest->triangles) continue;
        growth.push_back(
            {std::get<0>(key),
             std::get<1>(key),
             std::get<2>(key),
             ends.smallest->triangles,
             ends.largest->triangles,
             ends.smallest->ours_mrays / ends.largest->ours_mrays,
             ends.smallest->peer_mrays / ends.largest->peer_mrays}
        );
    }
    return growth;
}

std::vector<ThreadRow> bench_threads(
    const std::string& title,
    const Scene& scene,
    const WorkloadParams& workload,
    const Effort& effort,
    const Executor& all_threads,
    const Progress& progress
) {
    if (all_threads.threads() == 1) return {};
    progress.step(title + ": one thread and all", 0, 0);
    constexpr std::array classes = {RayClass::sun, RayClass::diffuse_bounce};
    const Workload made = make_workload(
        scene, ExactOracle(scene.view(), all_threads), classes, workload, all_threads
    );
    const std::vector<Ray>& sun = made.classes.front().emitters.front().rays;
    const std::vector<Ray>& bounces = made.classes.back().emitters.front().rays;
    const Accelerator accelerator = build_accelerator(
        scene, made.areas, {.use = {.expected_rays = 1e9}}, all_threads, progress
    );
    const AreaHandle area = accelerator[made.areas.front().name];
    const auto occluded = std::make_unique<bool[]>(sun.size());
    std::vector<Hit> hits(bounces.size());

    ThreadBench bench(title, effort, all_threads);
    bench.measure("global tree", [&](const Executor& executor) {
        static_cast<void>(build_accelerator(scene, {}, {}, executor, progress));
    });
    bench.measure("pencil grid", [&](const Executor& executor) {
        static_cast<void>(build_pencil_grid(scene.view(), area.pencil(), {}, executor));
    });
    bench.measure("sun rays", [&](const Executor& executor) {
        area.any_hits(sun, {occluded.get(), sun.size()}, executor);
    });
    bench.measure("diffuse bounces", [&](const Executor& executor) {
        accelerator.closest_hits(bounces, hits, executor);
    });
    return bench.take();
}

} // namespace raywise::app
