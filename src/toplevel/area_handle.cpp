// Queries of callers who know which area their rays belong to.
#include "toplevel/batches.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/inversion.hpp>
#include <raywise/pencil/pencil.hpp>
#include <raywise/pencil/pencil_grid.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/pencil_of.hpp>
#include <raywise/toplevel/served.hpp>
#include <raywise/toplevel/structure_choice.hpp>
#include <raywise/trace/wide.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raywise {
namespace {

/// The pencil that shadow rays of the area belong to.
Pencil shadow_pencil(const InfluenceArea& area) {
    const std::optional<Pencil> pencil = central_pencil_of(area);
    if (!pencil) throw Error("occluded: area '" + area.name + "' has no emitter to point to");
    return *pencil;
}

/// The shadow ray that starts `offset` scene units away from the point.
Ray shadow_ray(const Pencil& pencil, Vec3 point, float offset) {
    Ray ray = pencil.shadow_ray(point);
    ray.t_min = offset;
    if (pencil.kind() == Pencil::Kind::radial) {
        const double distance = length(to_double(ray.direction));
        ray.t_min = static_cast<float>(static_cast<double>(offset) / distance);
    }
    return ray;
}

/// Answers the rays that `ray_of(i)` makes, a block at a time: large enough to be drawn over,
/// without room for all rays at once.
template <class RayOf>
void occluded_by_blocks(
    const AreaHandle& handle,
    std::span<bool> shadowed,
    const Executor& executor,
    const RayOf& ray_of
) {
    constexpr std::size_t block = std::size_t{1} << 18;
    std::vector<Ray> rays(std::min(block, shadowed.size()));
    for (std::size_t first = 0; first < shadowed.size(); first += block) {
        const std::size_t count = std::min(block, shadowed.size() - first);
        executor
            .for_each_chunk(count, detail::batch_chunk, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    rays[i] = ray_of(first + i);
            });
        handle.any_hits(std::span(rays).first(count), shadowed.subspan(first, count), executor);
    }
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
    executor
        .for_each_chunk(rays.size(), detail::batch_chunk, [&](std::size_t begin, std::size_t end) {
            work(rays.subspan(begin, end - begin), answers.subspan(begin, end - begin));
        });
}

} // namespace

const LocalStructure& AreaHandle::structure() const {
    return owner_->local(id_);
}

const WideBvh* AreaHandle::whole_tree() const {
    const LocalStructure& own = structure();
    if (own.is_whole && own.has_tree) return own.tree.wide();
    return own.has_tree ? nullptr : owner_->global_tree().wide();
}

const InfluenceArea& AreaHandle::area() const {
    return owner_->areas()[static_cast<std::size_t>(id_)];
}

const Pencil& AreaHandle::pencil() const {
    if (!structure().pencil) throw Error("accelerator: area '" + area().name + "' is not exact");
    return *structure().pencil;
}

const StructureChoice& AreaHandle::choice() const {
    return structure().choice;
}

std::string AreaHandle::explain() const {
    return raywise::explain(choice());
}

std::optional<Hit> AreaHandle::closest_hit(const Ray& ray) const {
    if (!is_gridded(ray)) return closest_hit_by_trees(ray);
    // One result from the first write to the last reader: copies of what was just written stall.
    std::optional<Hit> hit;
    const Verdict verdict = grid_->closest_hit(ray, hit.emplace());
    if (verdict == Verdict::miss) hit.reset();
    if (verdict == Verdict::unknown) hit = closest_hit_by_trees(ray);
    return hit;
}

std::optional<Hit> AreaHandle::closest_hit_by_trees(const Ray& ray) const {
    if (const WideBvh* whole = whole_tree()) return raywise::closest_hit(*whole, ray);
    SilentQuery nobody;
    return closest_hit(ray, nobody);
}

bool AreaHandle::any_hit(const Ray& ray) const {
    if (is_gridded(ray)) {
        const Verdict verdict = grid_->any_hit(ray);
        if (verdict != Verdict::unknown) return verdict == Verdict::hit;
    }
    if (const WideBvh* whole = whole_tree()) return raywise::any_hit(*whole, ray);
    SilentQuery nobody;
    return any_hit(ray, nobody);
}

bool AreaHandle::is_gridded(std::span<const Ray> rays) const {
    return grid_ != nullptr &&
           std::all_of(rays.begin(), rays.end(), [&](const Ray& ray) { return is_gridded(ray); });
}

bool AreaHandle::are_exact(std::span<const Ray> rays, const Executor& executor) const {
    const std::optional<Pencil>& pencil = structure().pencil;
    if (!pencil) return false;
    std::atomic<bool> all = true;
    constexpr std::size_t chunk = 1 << 14;
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        const auto part = rays.subspan(begin, end - begin);
        const bool held = std::all_of(part.begin(), part.end(), [&](const Ray& ray) {
            return is_valid(ray) && pencil->holds(ray);
        });
        if (!held) all = false;
    });
    return all;
}

bool AreaHandle::is_worth_drawing(std::size_t rays) const {
    const auto& triangles = structure().triangles;
    // Every triangle is looked at, which takes about as long as a tenth of a traced ray.
    return grid_ == nullptr && triangles != nullptr && rays >= triangles->view().size() / 8;
}

void AreaHandle::closest_hits(
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor
) const {
    detail::check_answers(rays.size(), hits.size());
    const LocalStructure& own = structure();
    if (is_worth_drawing(rays.size()) && are_exact(rays, executor)) {
        closest_hits_once(own.triangles->view(), *own.pencil, rays, hits, executor);
        return;
    }
    const auto answer = [&](const Ray& ray) { return closest_hit(ray).value_or(Hit{}); };
    for_each_part(rays, hits, executor, [&](std::span<const Ray> part, std::span<Hit> answers) {
        if (is_gridded(part))
            grid_->closest_hits(part, answers, answer);
        else
            std::transform(part.begin(), part.end(), answers.begin(), answer);
    });
}

void AreaHandle::any_hits(
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor
) const {
    detail::check_answers(rays.size(), occluded.size());
    const LocalStructure& own = structure();
    if (is_worth_drawing(rays.size()) && are_exact(rays, executor)) {
        any_hits_once(own.triangles->view(), *own.pencil, rays, occluded, executor);
        return;
    }
    const auto answer = [&](const Ray& ray) { return any_hit(ray); };
    for_each_part(
        rays,
        occluded,
        executor,
        [&](std::span<const Ray> part, std::span<bool> answers) {
            if (is_gridded(part))
                grid_->any_hits(part, answers, answer);
            else
                std::transform(part.begin(), part.end(), answers.begin(), answer);
        }
    );
}

void AreaHandle::occluded(
    std::span<const Vec3> points,
    std::span<bool> shadowed,
    float offset,
    const Executor& executor
) const {
    detail::check_answers(points.size(), shadowed.size());
    if (!(offset >= 0) || !std::isfinite(offset)) {
        throw Error("occluded: offset must be finite and at least 0");
    }
    const Pencil pencil = shadow_pencil(area());
    occluded_by_blocks(*this, shadowed, executor, [&](std::size_t i) {
        return shadow_ray(pencil, points[i], offset);
    });
}

void AreaHandle::occluded(
    std::span<const Vec3> points,
    std::span<const PrimId> surfaces,
    std::span<bool> shadowed,
    const Executor& executor
) const {
    detail::check_answers(points.size(), shadowed.size());
    detail::check_answers(points.size(), surfaces.size());
    const Pencil pencil = shadow_pencil(area());
    occluded_by_blocks(*this, shadowed, executor, [&](std::size_t i) {
        return pencil.shadow_ray(points[i], 0, surfaces[i]);
    });
}

} // namespace raywise
