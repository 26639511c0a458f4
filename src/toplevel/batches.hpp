// Batches by single queries, for whatever answers them.
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

template <class Structure>
void closest_batch(
    const Structure& structure,
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor
) {
    check_answers(rays.size(), hits.size());
    executor.for_each_chunk(rays.size(), batch_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            hits[i] = structure.closest_hit(rays[i]).value_or(Hit{});
    });
}

template <class Structure>
void any_batch(
    const Structure& structure,
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor
) {
    check_answers(rays.size(), occluded.size());
    executor.for_each_chunk(rays.size(), batch_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            occluded[i] = structure.any_hit(rays[i]);
    });
}

} // namespace raywise::detail
