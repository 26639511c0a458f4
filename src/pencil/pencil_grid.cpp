#include <raywise/pencil/pencil_grid.hpp>

#include "pencil/grid_data.hpp"
#include "pencil/kernels.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/core/hash.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil.hpp>
#include <raywise/pencil/pencil_grid_params.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raywise {

namespace {

using namespace pencil_detail;

constexpr std::size_t batch_chunk = 1 << 12;

} // namespace

PencilGrid::PencilGrid(std::unique_ptr<Data> data) : data_(std::move(data)) {}

PencilGrid::~PencilGrid() = default;
PencilGrid::PencilGrid(PencilGrid&&) noexcept = default;
PencilGrid& PencilGrid::operator=(PencilGrid&&) noexcept = default;

const Pencil& PencilGrid::pencil() const {
    return data_->pencil;
}

Verdict PencilGrid::any_hit(const Ray& ray) const {
    return data_->kernels->any_hit(*data_, ray);
}

Verdict PencilGrid::any_hit(const Ray& ray, PencilGridCounts& counts) const {
    return data_->kernels->any_hit_counted(*data_, ray, counts);
}

Verdict PencilGrid::occluded(const Vec3& point, float t_min, PrimId excluded) const {
    return data_->kernels->occluded(*data_, point, t_min, excluded);
}

Verdict PencilGrid::closest_hit(const Ray& ray, Hit& hit) const {
    return data_->kernels->closest_hit(*data_, ray, hit);
}

Verdict PencilGrid::closest_hit(const Ray& ray, Hit& hit, PencilGridCounts& counts) const {
    return data_->kernels->closest_hit_counted(*data_, ray, hit, counts);
}

Verdict PencilGrid::all_hits(const Ray& ray, FunctionRef<void(const Hit&)> visit) const {
    return data_->kernels->all_hits(*data_, ray, visit);
}

void PencilGrid::any_hits(
    std::span<const Ray> rays,
    std::span<bool> hits,
    FunctionRef<bool(const Ray&)> otherwise,
    const Executor& executor
) const {
    executor.for_each_chunk(rays.size(), batch_chunk, [&](std::size_t begin, std::size_t end) {
        std::array<Verdict, batch_chunk> verdicts; // NOLINT(*-member-init): written by the kernel
        data_->kernels->any_hit_batch(*data_, rays.data() + begin, end - begin, verdicts.data());
        for (std::size_t i = begin; i < end; ++i) {
            const Verdict verdict = verdicts[i - begin];
            hits[i] = verdict == Verdict::unknown ? otherwise(rays[i]) : verdict == Verdict::hit;
        }
    });
}

void PencilGrid::closest_hits(
    std::span<const Ray> rays,
    std::span<Hit> hits,
    FunctionRef<Hit(const Ray&)> otherwise,
    const Executor& executor
) const {
    executor.for_each_chunk(rays.size(), batch_chunk, [&](std::size_t begin, std::size_t end) {
        std::array<Verdict, batch_chunk> verdicts; // NOLINT(*-member-init): written by the kernel
        std::fill(&hits[begin], &hits[begin] + (end - begin), Hit{});
        data_->kernels->closest_hit_batch(
            *data_, rays.data() + begin, end - begin, hits.data() + begin, verdicts.data()
        );
        for (std::size_t i = begin; i < end; ++i)
            if (verdicts[i - begin] == Verdict::unknown) hits[i] = otherwise(rays[i]);
    });
}

void PencilGrid::occluded(
    std::span<const Vec3> points,
    float t_min,
    std::span<const PrimId> excluded,
    std::span<bool> shadowed,
    FunctionRef<bool(const Ray&)> otherwise,
    const Executor& executor
) const {
    executor.for_each_chunk(points.size(), batch_chunk, [&](std::size_t begin, std::size_t end) {
        std::array<Verdict, batch_chunk> verdicts; // NOLINT(*-member-init): written by the kernel
        const PointBatch batch{
            points.data() + begin,
            excluded.empty() ? nullptr : excluded.data() + begin,
            t_min,
            end - begin
        };
        data_->kernels->occluded_batch(*data_, batch, verdicts.data());
        for (std::size_t i = begin; i < end; ++i) {
            const Verdict verdict = verdicts[i - begin];
            shadowed[i] = verdict == Verdict::hit;
            if (verdict == Verdict::unknown)
                shadowed[i] = otherwise(data_->pencil.shadow_ray(
                    points[i], t_min, excluded.empty() ? no_prim : excluded[i]
                ));
        }
    });
}

const PencilGridStatistics& PencilGrid::statistics() const {
    return data_->statistics;
}

std::size_t PencilGrid::size_in_bytes() const {
    return data_->memory_bytes + data_->near.size() * sizeof(PrimId) + sizeof(Data);
}

std::uint64_t PencilGrid::content_hash() const {
    const std::uint64_t hash = hash_bytes({data_->memory->get(), data_->memory_bytes});
    return hash_elements(std::span<const PrimId>(data_->near), hash);
}

std::string_view PencilGrid::instruction_set() const {
    return data_->kernels->name;
}

void PencilGrid::use_instruction_set(std::string_view name) {
    for (const Kernels* kernels : all_kernels())
        if (kernels->name == name) {
            data_->kernels = kernels;
            return;
        }
    throw Error("pencil grid: this machine has no instruction set " + std::string(name));
}

std::span<const std::string_view> PencilGrid::instruction_sets() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all;
        for (const Kernels* kernels : all_kernels())
            all.push_back(kernels->name);
        return all;
    }();
    return names;
}

} // namespace raywise
