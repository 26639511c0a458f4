// What a subcommand traces rays through: one tree, or the two-level structure. Same questions, same
// answers.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/trace/triangles.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace raywise::app {

struct SingleTree {
    Bvh tree;
    PackedTriangles triangles;
};

using Tracer = std::variant<SingleTree, Accelerator>;

/// The closest hit of every ray. Throws Cancelled when the progress asks to stop.
[[nodiscard]] std::vector<std::optional<Hit>> closest_hits(
    const Tracer& tracer,
    std::span<const Ray> rays,
    const Executor& executor,
    const Progress& progress
);

/// 1 for every ray that hits something, else 0.
[[nodiscard]] std::vector<std::uint8_t> any_hits(
    const Tracer& tracer,
    std::span<const Ray> rays,
    const Executor& executor,
    const Progress& progress
);

} // namespace raywise::app
