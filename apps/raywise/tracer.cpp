#include "tracer.hpp"

#include <raywise/core/executor.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace raywise::app {

namespace {

/// Answers every ray by `answer_one`, in blocks, so that progress is seen and a stop is heeded.
template <class Answer, class AnswerOne>
std::vector<Answer> answer_all(
    std::span<const Ray> rays,
    const Executor& executor,
    const Progress& progress,
    const AnswerOne& answer_one
) {
    constexpr std::size_t block = 1 << 16, chunk = 1 << 10;
    std::vector<Answer> answers(rays.size());
    for (std::size_t first = 0; first < rays.size(); first += block) {
        progress.step("tracing rays", first, rays.size());
        const std::size_t count = std::min(block, rays.size() - first);
        executor.for_each_chunk(count, chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = first + begin; i < first + end; ++i)
                answers[i] = answer_one(rays[i]);
        });
    }
    progress.step("tracing rays", rays.size(), rays.size());
    return answers;
}

} // namespace

std::vector<std::optional<Hit>> closest_hits(
    const Tracer& tracer,
    std::span<const Ray> rays,
    const Executor& executor,
    const Progress& progress
) {
    using Answer = std::optional<Hit>;
    if (const auto* single = std::get_if<SingleTree>(&tracer))
        return answer_all<Answer>(rays, executor, progress, [&](const Ray& ray) {
            return closest_hit(single->tree, single->triangles, ray);
        });
    const auto& accelerator = std::get<Accelerator>(tracer);
    return answer_all<Answer>(rays, executor, progress, [&](const Ray& ray) {
        return accelerator.closest_hit(ray);
    });
}

std::vector<std::uint8_t> any_hits(
    const Tracer& tracer,
    std::span<const Ray> rays,
    const Executor& executor,
    const Progress& progress
) {
    using Answer = std::uint8_t;
    if (const auto* single = std::get_if<SingleTree>(&tracer))
        return answer_all<Answer>(rays, executor, progress, [&](const Ray& ray) {
            return static_cast<Answer>(any_hit(single->tree, single->triangles, ray) ? 1 : 0);
        });
    const auto& accelerator = std::get<Accelerator>(tracer);
    return answer_all<Answer>(rays, executor, progress, [&](const Ray& ray) {
        return static_cast<Answer>(accelerator.any_hit(ray) ? 1 : 0);
    });
}

} // namespace raywise::app
