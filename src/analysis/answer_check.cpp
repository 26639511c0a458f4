#include <raywise/analysis/answer_check.hpp>

#include <raywise/analysis/exact_oracle.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/trace/brute_force.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

namespace raywise {

namespace {

void require_same_size(std::size_t rays, std::size_t answers) {
    if (rays != answers) throw Error("as many answers as rays are needed");
}

Hit or_miss(const std::optional<Hit>& hit) {
    return hit.value_or(Hit{});
}

bool is_same(const Hit& a, const Hit& b) {
    return a.prim == b.prim && a.t == b.t;
}

bool is_far_off(const Ray& ray, const Hit& right, const Hit& found, double tolerance) {
    if ((found.prim == no_prim) != (right.prim == no_prim)) return true;
    if (right.prim == no_prim) return false;
    const auto t = static_cast<double>(right.t);
    const Vec3d reach = abs(to_double(ray.origin)) + abs(to_double(ray.direction)) * t;
    const double scale = std::max({reach.x, reach.y, reach.z}) / length(to_double(ray.direction));
    return std::abs(static_cast<double>(found.t) - t) > tolerance * std::max(t, scale);
}

} // namespace

std::size_t count_wrong(std::span<const Hit> right, std::span<const Hit> found) {
    require_same_size(right.size(), found.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < right.size(); ++i)
        wrong += is_same(right[i], found[i]) ? 0U : 1U;
    return wrong;
}

std::size_t count_wrong(std::span<const bool> right, std::span<const bool> found) {
    require_same_size(right.size(), found.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < right.size(); ++i)
        wrong += right[i] == found[i] ? 0U : 1U;
    return wrong;
}

std::size_t count_far_off(
    std::span<const Ray> rays,
    std::span<const Hit> right,
    std::span<const Hit> found,
    double tolerance
) {
    require_same_size(rays.size(), right.size());
    require_same_size(rays.size(), found.size());
    if (!(tolerance > 0)) throw Error("count far off: the tolerance must be positive");
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i)
        wrong += is_far_off(rays[i], right[i], found[i], tolerance) ? 1U : 0U;
    return wrong;
}

std::size_t count_wrong_oracle_answers(
    const ExactOracle& oracle,
    const TriangleView& triangles,
    std::span<const Ray> rays,
    std::size_t samples,
    const Executor& executor
) {
    samples = std::min(samples, rays.size());
    std::atomic<std::size_t> wrong = 0;
    executor.for_each_chunk(samples, 1, [&](std::size_t i, std::size_t) {
        const Ray& ray = rays[i * rays.size() / samples];
        const Hit right = or_miss(brute_force_closest_hit(triangles, ray));
        const bool is_wrong = !is_same(right, or_miss(oracle.closest_hit(ray))) ||
                              oracle.any_hit(ray) != (right.prim != no_prim);
        if (is_wrong) wrong.fetch_add(1, std::memory_order_relaxed);
    });
    return wrong.load();
}

} // namespace raywise
