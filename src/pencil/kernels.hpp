// The queries of a pencil grid, once for every instruction set.
#pragma once

#include "pencil/grid_data.hpp"

#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/pencil/pencil_grid.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace raywise::pencil_detail {

/// Points of one batch: shadow rays with `excluded`, or none when that is null.
struct PointBatch {
    const Vec3* points;
    const PrimId* excluded;
    float t_min;
    std::size_t count;
};

using Grid = PencilGrid::Data;

struct Kernels {
    std::string_view name;
    Verdict (*occluded)(const Grid&, const Vec3& point, float t_min, PrimId excluded);
    Verdict (*any_hit)(const Grid&, const Ray&);
    Verdict (*any_hit_counted)(const Grid&, const Ray&, PencilGridCounts&);
    Verdict (*closest_hit)(const Grid&, const Ray&, Hit&);
    Verdict (*closest_hit_counted)(const Grid&, const Ray&, Hit&, PencilGridCounts&);
    Verdict (*all_hits)(const Grid&, const Ray&, FunctionRef<void(const Hit&)>);
    void (*occluded_batch)(const Grid&, const PointBatch&, Verdict*);
    void (*any_hit_batch)(const Grid&, const Ray*, std::size_t, Verdict*);
    void (*closest_hit_batch)(const Grid&, const Ray*, std::size_t, Hit*, Verdict*);
};

/// Best first; never empty.
[[nodiscard]] std::span<const Kernels* const> all_kernels();

[[nodiscard]] const Kernels& best_kernels();

/// The exact answer, when the filters leave a doubt. Apart, as it is rare.
[[nodiscard]] std::optional<Hit> decide(const Grid& grid, const Ray& ray, PrimId id, float t_max);

} // namespace raywise::pencil_detail
