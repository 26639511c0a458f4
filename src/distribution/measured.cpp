#include <raywise/distribution/measured.hpp>

#include "distribution/checks.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/distribution/uniform.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_box.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace raywise {

struct RayRecord {
    MeasuredParams params;
    UniformDistribution uniform;
    double total = 0;                                      // of the weights
    std::vector<double> cumulative;                        // of the weights, for sampling
    std::shared_ptr<const std::vector<std::uint32_t>> all; // 0, 1, 2, ...
};

namespace {

std::shared_ptr<const RayRecord> record_of(MeasuredParams params) {
    require(!params.rays.empty(), "a measured distribution", "of at least one ray");
    require(
        params.rays.size() <= std::numeric_limits<std::uint32_t>::max(),
        "a measured distribution",
        "of fewer than 2^32 rays"
    );
    require_not_negative(params.shrinkage, "the shrinkage");
    UniformDistribution uniform(params.bounds);
    std::vector<double> cumulative;
    cumulative.reserve(params.rays.size());
    double total = 0;
    for (const RecordedRay& recorded : params.rays) {
        require(is_valid(recorded.ray), "every recorded ray", "valid");
        require_not_negative(recorded.weight, "the weight of a recorded ray");
        total += recorded.weight;
        cumulative.push_back(total);
    }
    require_positive(total, "the total weight of the recorded rays");
    auto all = std::make_shared<std::vector<std::uint32_t>>(params.rays.size());
    std::iota(all->begin(), all->end(), 0U);
    return std::make_shared<const RayRecord>(RayRecord{
        .params = std::move(params),
        .uniform = uniform,
        .total = total,
        .cumulative = std::move(cumulative),
        .all = std::move(all)
    });
}

bool meets(const RecordedRay& recorded, const Aabb& box) {
    return intersect(recorded.ray, box).has_value();
}

} // namespace

MeasuredMeasure::MeasuredMeasure(std::shared_ptr<const RayRecord> record)
    : record_(std::move(record)), selected_(record_->all) {}

float MeasuredMeasure::operator()(const Aabb& box) const {
    if (box.is_empty()) return 0;
    const MeasuredParams& params = record_->params;
    double met = 0;
    for (const std::uint32_t i : *selected_)
        if (meets(params.rays[i], box)) met += params.rays[i].weight;
    const auto uniform = static_cast<double>(record_->uniform.measure()(box));
    const double share = (met + params.shrinkage * uniform) / (record_->total + params.shrinkage);
    return static_cast<float>(std::min(share, 1.0));
}

MeasuredMeasure MeasuredMeasure::narrowed(const Aabb& box) const {
    auto kept = std::make_shared<std::vector<std::uint32_t>>();
    for (const std::uint32_t i : *selected_)
        if (meets(record_->params.rays[i], box)) kept->push_back(i);
    MeasuredMeasure result = *this;
    result.selected_ = std::move(kept);
    return result;
}

double MeasuredMeasure::shared(const Aabb& a, const Aabb& b) const {
    double met = 0;
    for (const std::uint32_t i : *selected_) {
        const RecordedRay& recorded = record_->params.rays[i];
        if (meets(recorded, a) && meets(recorded, b)) met += recorded.weight;
    }
    return met / record_->total;
}

MeasuredDistribution::MeasuredDistribution(MeasuredParams params)
    : record_(record_of(std::move(params))) {}

const MeasuredParams& MeasuredDistribution::params() const {
    return record_->params;
}

Ray MeasuredDistribution::sample(Rng& rng) const {
    const double at = rng.uniform_double() * (record_->total + record_->params.shrinkage);
    const std::vector<double>& cumulative = record_->cumulative;
    const auto found = std::upper_bound(cumulative.begin(), cumulative.end(), at);
    if (found == cumulative.end() && record_->params.shrinkage > 0)
        return record_->uniform.sample(rng);
    const auto index =
        std::min(static_cast<std::size_t>(found - cumulative.begin()), cumulative.size() - 1);
    return record_->params.rays[index].ray;
}

double MeasuredDistribution::density(const Ray& ray) const {
    double weight = 0;
    for (const RecordedRay& recorded : record_->params.rays) {
        const Ray& r = recorded.ray;
        if (r.origin == ray.origin && r.direction == ray.direction && r.t_min == ray.t_min &&
            r.t_max == ray.t_max)
            weight += recorded.weight;
    }
    return weight / (record_->total + record_->params.shrinkage);
}

Vec3d MeasuredDistribution::direction_at(const Aabb& box) const {
    Vec3d sum;
    Vec3d sum_of_all;
    for (const RecordedRay& recorded : record_->params.rays) {
        const Vec3d direction = abs(normalized(to_double(recorded.ray.direction)));
        sum_of_all = sum_of_all + direction * recorded.weight;
        if (meets(recorded, box)) sum = sum + direction * recorded.weight;
    }
    return sum == Vec3d{} ? sum_of_all : sum;
}

} // namespace raywise
