// What steps and builds take, in nanoseconds of one core: the constants behind the choice of a
// structure. Measured by the bench of docs/performance.md; only their ratios decide.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/pencil/inversion.hpp>
#include <raywise/pencil/pencil.hpp>
#include <raywise/toplevel/structure_choice.hpp>
#include <raywise/trace/observer.hpp>

#include <cstddef>

namespace raywise::detail {

/// Of tracing a wide tree: a node visit waits for its cache lines and for a guessed branch, which
/// takes longer than its arithmetic.
[[nodiscard]] inline double predicted_ns(const Counts& counts) {
    constexpr double visit_ns = 20;
    constexpr double test_ns = 5;
    return visit_ns * static_cast<double>(counts.node_visits()) +
           test_ns * static_cast<double>(counts.prims);
}

/// A pencil grid over so many triangles, its rays in batches, as those of an inversion. Six faces
/// list more than one does.
[[nodiscard]] inline StructurePrediction
predict_grid(Pencil::Kind kind, double triangles, const Executor& executor) {
    const bool is_parallel = kind == Pencil::Kind::parallel;
    const double build_ns = is_parallel ? 1000 : 2000; // per triangle, serial
    const double ray_ns = is_parallel ? 50 : 70;
    return {StructureKind::pencil_grid, build_ns * triangles / executor.threads(), ray_ns};
}

/// A framed tree over so many triangles; its rays must be counted.
[[nodiscard]] inline StructurePrediction
predict_framed(std::size_t triangles, const Executor& executor) {
    constexpr double build_ns = 4000; // per triangle, serial
    const auto count = static_cast<double>(triangles);
    return {StructureKind::framed_tree, build_ns * count / executor.threads(), 0};
}

/// One batch of all rays, drawn over: nothing is built, but every triangle is looked at.
[[nodiscard]] inline StructurePrediction
predict_inversion(Pencil::Kind kind, std::size_t triangles, const Executor& executor) {
    constexpr std::size_t many = 1'000'000;
    const double build_ns = predicted_inversion_ns(kind, triangles, 0);
    const double ray_ns = (predicted_inversion_ns(kind, triangles, many) - build_ns) / double{many};
    return {StructureKind::inversion, build_ns / executor.threads(), ray_ns};
}

} // namespace raywise::detail
