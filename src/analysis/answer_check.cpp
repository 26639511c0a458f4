#include <raywise/analysis/answer_check.hpp>

#include <raywise/core/error.hpp>
#include <raywise/trace/brute_force.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

namespace raywise {

namespace {

constexpr std::size_t rays_per_chunk = 1024;

/// Calls `is_wrong(i)` for every ray, in parallel, and counts.
template <class IsWrong>
std::size_t count_wrong(
    std::size_t count,
    std::size_t chunk,
    const Executor& executor,
    const IsWrong& is_wrong
) {
    std::atomic<std::size_t> wrong = 0;
    executor.for_each_chunk(count, chunk, [&](std::size_t begin, std::size_t end) {
        std::size_t in_chunk = 0;
        for (std::size_t i = begin; i < end; ++i)
            in_chunk += is_wrong(i) ? 1U : 0U;
        wrong.fetch_add(in_chunk, std::memory_order_relaxed);
    });
    return wrong.load();
}

void require_same_size(std::size_t rays, std::size_t answers) {
    if (rays != answers) throw Error("as many answers as rays are needed");
}

Hit or_miss(const std::optional<Hit>& hit) {
    return hit.value_or(Hit{});
}

bool is_far_apart(const Ray& ray, const Hit& found, const Hit& right) {
    if ((found.prim == no_prim) != (right.prim == no_prim)) return true;
    if (right.prim == no_prim) return false;
    const double t = static_cast<double>(right.t);
    const Vec3d point = abs(to_double(ray.origin)) + abs(to_double(ray.direction)) * t;
    const double reach = std::max({point.x, point.y, point.z}) / length(to_double(ray.direction));
    return std::abs(static_cast<double>(found.t) - t) > loose_tolerance * std::max(t, reach);
}

} // namespace

std::size_t count_wrong_hits(
    const ExactOracle& oracle,
    std::span<const Ray> rays,
    std::span<const Hit> hits,
    const Executor& executor
) {
    require_same_size(rays.size(), hits.size());
    return count_wrong(rays.size(), rays_per_chunk, executor, [&](std::size_t i) {
        const Hit right = or_miss(oracle.closest_hit(rays[i]));
        return hits[i].prim != right.prim || hits[i].t != right.t;
    });
}

std::size_t count_wrong_occlusions(
    const ExactOracle& oracle,
    std::span<const Ray> rays,
    std::span<const bool> occluded,
    const Executor& executor
) {
    require_same_size(rays.size(), occluded.size());
    return count_wrong(rays.size(), rays_per_chunk, executor, [&](std::size_t i) {
        return occluded[i] != oracle.any_hit(rays[i]);
    });
}

std::size_t count_grossly_wrong_hits(
    const ExactOracle& oracle,
    std::span<const Ray> rays,
    std::span<const Hit> hits,
    const Executor& executor
) {
    require_same_size(rays.size(), hits.size());
    return count_wrong(rays.size(), rays_per_chunk, executor, [&](std::size_t i) {
        return is_far_apart(rays[i], hits[i], or_miss(oracle.closest_hit(rays[i])));
    });
}

std::size_t count_wrong_oracle_answers(
    const ExactOracle& oracle,
    const TriangleView& triangles,
    std::span<const Ray> rays,
    std::size_t samples,
    const Executor& executor
) {
    samples = std::min(samples, rays.size());
    return count_wrong(samples, 1, executor, [&](std::size_t i) {
        const Ray& ray = rays[i * rays.size() / samples];
        const Hit right = or_miss(brute_force_closest_hit(triangles, ray));
        const Hit found = or_miss(oracle.closest_hit(ray));
        return found.prim != right.prim || found.t != right.t ||
               oracle.any_hit(ray) != (right.prim != no_prim);
    });
}

} // namespace raywise
