#include <raywise/geometry/segment_measure.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace raywise {

namespace {

constexpr std::size_t lanes = 4;
using Lane [[gnu::vector_size(16)]] = float;
using Mask [[gnu::vector_size(16)]] = std::int32_t;

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Finite, so that a slab is never 0 times infinity.
float inverse(float direction) {
    constexpr float least = 0x1p-100F;
    return 1 / (std::abs(direction) < least ? std::copysign(least, direction) : direction);
}

/// The box's planes, each in all lanes.
struct Planes {
    std::array<Lane, 3> lo{};
    std::array<Lane, 3> hi{};

    explicit Planes(const Aabb& box) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            lo[k] = Lane{box.lo[axis], box.lo[axis], box.lo[axis], box.lo[axis]};
            hi[k] = Lane{box.hi[axis], box.hi[axis], box.hi[axis], box.hi[axis]};
        }
    }
};

} // namespace

/// Four segments; unused lanes start at +inf and end at -inf, so that they meet nothing.
struct SegmentMeasure::Block {
    std::array<Lane, 3> origin{};
    std::array<Lane, 3> inverse{};
    Lane t_min{infinity, infinity, infinity, infinity};
    Lane t_max{-infinity, -infinity, -infinity, -infinity};

    /// -1 in the lanes of segments that meet the box. Rounding keeps the order of planes, so a
    /// larger box is never met by fewer.
    [[nodiscard]] Mask meets(const Planes& box) const {
        Lane entry = t_min;
        Lane exit = t_max;
        for (std::size_t k = 0; k < 3; ++k) {
            const Lane a = (box.lo[k] - origin[k]) * inverse[k];
            const Lane b = (box.hi[k] - origin[k]) * inverse[k];
            const Lane near = a < b ? a : b;
            const Lane far = a < b ? b : a;
            entry = near > entry ? near : entry;
            exit = far < exit ? far : exit;
        }
        return entry <= exit;
    }

    void copy(std::size_t to, const Block& other, std::size_t from) {
        for (std::size_t k = 0; k < 3; ++k) {
            origin[k][to] = other.origin[k][from];
            inverse[k][to] = other.inverse[k][from];
        }
        t_min[to] = other.t_min[from];
        t_max[to] = other.t_max[from];
    }
};

SegmentMeasure::SegmentMeasure(std::span<const Ray> rays, const Aabb& bounds, double shrinkage) {
    if (!(shrinkage >= 0) || !std::isfinite(shrinkage))
        throw Error("segment measure: the shrinkage must be finite and not negative");
    auto blocks = std::make_shared<std::vector<Block>>();
    for (const Ray& ray : rays) {
        if (!is_valid(ray)) continue;
        const std::size_t lane = segment_count_++ % lanes;
        if (lane == 0) blocks->emplace_back();
        Block& block = blocks->back();
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            block.origin[k][lane] = ray.origin[axis];
            block.inverse[k][lane] = inverse(ray.direction[axis]);
        }
        block.t_min[lane] = ray.t_min;
        block.t_max[lane] = ray.t_max;
    }
    const auto count = static_cast<double>(segment_count_);
    const auto area = static_cast<double>(half_area(bounds));
    // Without segments, the surface area is all there is.
    if (segment_count_ > 0) per_segment_ = 1 / (count * (1 + shrinkage));
    const double surface_share = segment_count_ > 0 ? shrinkage / (1 + shrinkage) : 1.0;
    if (area > 0) per_area_ = surface_share / area;
    blocks_ = std::move(blocks);
}

std::size_t SegmentMeasure::count(const Aabb& box) const {
    if (box.is_empty()) return 0;
    const Planes planes(box);
    Mask sum{};
    for (const Block& block : *blocks_)
        sum -= block.meets(planes);
    return static_cast<std::size_t>(sum[0]) + static_cast<std::size_t>(sum[1]) +
           static_cast<std::size_t>(sum[2]) + static_cast<std::size_t>(sum[3]);
}

float SegmentMeasure::operator()(const Aabb& box) const {
    if (box.is_empty()) return 0;
    const auto met = static_cast<double>(count(box));
    const auto area = static_cast<double>(half_area(box));
    return static_cast<float>(met * per_segment_ + area * per_area_);
}

SegmentMeasure SegmentMeasure::narrowed(const Aabb& box) const {
    const std::size_t met = count(box);
    SegmentMeasure result = *this;
    // Copying pays when it leaves clearly fewer.
    if (4 * met > 3 * segment_count_) return result;
    auto kept = std::make_shared<std::vector<Block>>((met + lanes - 1) / lanes);
    const Planes planes(box);
    std::size_t next = 0;
    for (const Block& block : *blocks_) {
        const Mask mask = block.meets(planes);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            if (mask[lane] == 0) continue;
            (*kept)[next / lanes].copy(next % lanes, block, lane);
            ++next;
        }
    }
    result.blocks_ = std::move(kept);
    result.segment_count_ = met;
    return result;
}

} // namespace raywise
