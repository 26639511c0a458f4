// What the batches of an accelerator and of its areas share.
#pragma once

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>

#include <cstddef>
#include <span>

namespace raywise::detail {

inline constexpr std::size_t batch_chunk = 1024; ///< rays per task

inline void check_answers(std::size_t questions, std::size_t answers) {
    if (questions != answers) throw Error("accelerator: as many answers as questions are needed");
}

/// Calls `work(rays, answers)` for parts of a batch that stay in the cache between a look at their
/// rays and the tracing of them.
template <class Answer, class Work>
void for_each_part(
    std::span<const Ray> rays,
    std::span<Answer> answers,
    const Executor& executor,
    const Work& work
) {
    executor.for_each_chunk(rays.size(), batch_chunk, [&](std::size_t begin, std::size_t end) {
        work(rays.subspan(begin, end - begin), answers.subspan(begin, end - begin));
    });
}

} // namespace raywise::detail
