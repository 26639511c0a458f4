// Queries of callers who know which area their rays belong to.
#include "toplevel/batches.hpp"
#include "toplevel/faster_way.hpp"

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

} // namespace

const LocalStructure& AreaHandle::structure() const {
    return owner_->local(id_);
}

const WideBvh* AreaHandle::whole_tree() const {
    const LocalStructure& own = structure();
    if (own.is_whole && own.has_tree) return own.tree.wide();
    return own.has_tree ? nullptr : owner_->global_tree().wide();
}

TraceMode AreaHandle::trace_mode() const {
    return owner_->params().trace_mode;
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
    if (grid_ == nullptr) return closest_hit_by_trees(ray);
    // One result from the first write to the last reader: copies of what was just written stall.
    std::optional<Hit> hit;
    const Verdict verdict = grid_->closest_hit(ray, hit.emplace());
    if (verdict == Verdict::miss) hit.reset();
    if (verdict == Verdict::unknown) hit = closest_hit_by_trees(ray);
    return hit;
}

std::optional<Hit> AreaHandle::closest_hit_by_trees(const Ray& ray) const {
    if (const WideBvh* whole = whole_tree()) return raywise::closest_hit(*whole, ray, trace_mode());
    if (!is_valid(ray)) return std::nullopt;
    SilentQuery nobody;
    return owner_->closest_by_mode(ray, owner_->candidates_in(id_, ray), nobody);
}

bool AreaHandle::any_hit(const Ray& ray) const {
    if (grid_ == nullptr) return any_hit_by_trees(ray);
    const Verdict verdict = grid_->any_hit(ray);
    return verdict == Verdict::unknown ? any_hit_by_trees(ray) : verdict == Verdict::hit;
}

bool AreaHandle::occluded(const Vec3& point, float t_min, PrimId surface) const {
    if (grid_ != nullptr) {
        const Verdict verdict = grid_->occluded(point, t_min, surface);
        if (verdict != Verdict::unknown) return verdict == Verdict::hit;
    }
    return any_hit_by_trees(pencil().shadow_ray(point, t_min, surface));
}

bool AreaHandle::any_hit_by_trees(const Ray& ray) const {
    if (const WideBvh* whole = whole_tree()) return raywise::any_hit(*whole, ray, trace_mode());
    if (!is_valid(ray)) return false;
    SilentQuery nobody;
    return owner_->any_by_mode(ray, owner_->candidates_in(id_, ray), nobody);
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

/// By the area's grid, by the tree over everything, or ray by ray where there is neither. A grid
/// has a rival in the tree, which traces rays of a batch in groups: that pays where they meet the
/// same nodes.
template <class Answer, class ByGrid, class ByWhole, class ByTrees>
void AreaHandle::answer_batch(
    std::span<const Ray> rays,
    std::span<Answer> answers,
    const Executor& executor,
    const ByGrid& by_grid,
    const ByWhole& by_whole,
    const ByTrees& by_trees
) const {
    const bool has_rival = whole_tree() != nullptr && trace_mode() == TraceMode::watertight;
    const auto in_parts = [&](const auto& way) {
        return [&](std::size_t begin, std::size_t end, const Executor& by) {
            way(rays.subspan(begin, end - begin), answers.subspan(begin, end - begin), by);
        };
    };
    if (grid_ != nullptr && has_rival)
        return detail::take_faster_way(
            rays.size(), executor, in_parts(by_grid), in_parts(by_whole)
        );
    if (grid_ != nullptr) return by_grid(rays, answers, executor);
    if (whole_tree() != nullptr) return by_whole(rays, answers, executor);
    detail::for_each_part(
        rays,
        answers,
        executor,
        [&](std::span<const Ray> part, std::span<Answer> to) {
            std::transform(part.begin(), part.end(), to.begin(), by_trees);
        }
    );
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
    const auto by_trees = [&](const Ray& ray) { return closest_hit_by_trees(ray).value_or(Hit{}); };
    answer_batch(
        rays,
        hits,
        executor,
        [&](std::span<const Ray> part, std::span<Hit> answers, const Executor& by) {
            grid_->closest_hits(part, answers, by_trees, by);
        },
        [&](std::span<const Ray> part, std::span<Hit> answers, const Executor& by) {
            raywise::closest_hits(*whole_tree(), part, answers, by, trace_mode());
        },
        by_trees
    );
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
    const auto by_trees = [&](const Ray& ray) { return any_hit_by_trees(ray); };
    answer_batch(
        rays,
        occluded,
        executor,
        [&](std::span<const Ray> part, std::span<bool> answers, const Executor& by) {
            grid_->any_hits(part, answers, by_trees, by);
        },
        [&](std::span<const Ray> part, std::span<bool> answers, const Executor& by) {
            raywise::any_hits(*whole_tree(), part, answers, by, trace_mode());
        },
        by_trees
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
