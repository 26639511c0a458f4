#include <raywise/analysis/ray_order.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace raywise {

namespace {

/// Two zeros between the ten lowest bits.
std::uint32_t spread_by_3(std::uint32_t bits) {
    bits = (bits | (bits << 16U)) & 0x030000FFU;
    bits = (bits | (bits << 8U)) & 0x0300F00FU;
    bits = (bits | (bits << 4U)) & 0x030C30C3U;
    return (bits | (bits << 2U)) & 0x09249249U;
}

/// A zero between the sixteen lowest bits.
std::uint32_t spread_by_2(std::uint32_t bits) {
    bits = (bits | (bits << 8U)) & 0x00FF00FFU;
    bits = (bits | (bits << 4U)) & 0x0F0F0F0FU;
    bits = (bits | (bits << 2U)) & 0x33333333U;
    return (bits | (bits << 1U)) & 0x55555555U;
}

/// `value` in [lo, lo + 1 / scale] as a number of so many steps; anything for a NaN.
std::uint32_t step_of(float value, float lo, float scale, float steps) {
    const float share = (value - lo) * scale * steps;
    return static_cast<std::uint32_t>(std::max(0.0F, std::min(share, steps - 1)));
}

float inverse_or_zero(float extent) {
    return extent > 0 && std::isfinite(1 / extent) ? 1 / extent : 0.0F;
}

/// Three coordinates within a box, 10 bits each.
class MortonInBox {
public:
    explicit MortonInBox(const Aabb& box)
        : lo_(box.lo)
        , scale_{
              inverse_or_zero(box.size().x),
              inverse_or_zero(box.size().y),
              inverse_or_zero(box.size().z)
          } {}

    [[nodiscard]] std::uint32_t operator()(Vec3 point) const {
        constexpr float steps = 1024;
        return (spread_by_3(step_of(point.x, lo_.x, scale_.x, steps)) << 2U) |
               (spread_by_3(step_of(point.y, lo_.y, scale_.y, steps)) << 1U) |
               spread_by_3(step_of(point.z, lo_.z, scale_.z, steps));
    }

private:
    Vec3 lo_;
    Vec3 scale_;
};

Aabb bounds_of_origins(std::span<const Ray> rays) {
    Aabb box;
    for (const Ray& ray : rays)
        box = unite(box, ray.origin);
    return box;
}

/// The direction on the face of a cube, 13 bits each way, after 3 bits for the face.
std::uint32_t key_of_direction(Vec3 direction) {
    constexpr float steps = 8192;
    const int axis = dominant_axis(direction);
    const int right = axis == 2 ? 0 : axis + 1;
    const int up = right == 2 ? 0 : right + 1;
    const float depth = std::abs(direction[axis]);
    const auto face = static_cast<std::uint32_t>(2 * axis + (direction[axis] < 0 ? 1 : 0));
    const auto step = [&](int side) {
        return spread_by_2(step_of(direction[side] / depth, -1, 0.5F, steps));
    };
    return (face << 26U) | (step(right) << 1U) | step(up);
}

std::vector<std::uint32_t> keys_by_origin(std::span<const Ray> rays, bool by_octant) {
    const MortonInBox morton(bounds_of_origins(rays));
    std::vector<std::uint32_t> keys;
    keys.reserve(rays.size());
    for (const Ray& ray : rays) {
        std::uint32_t key = morton(ray.origin);
        if (by_octant) {
            const Vec3 d = ray.direction;
            const auto octant = (d.x < 0 ? 4U : 0U) | (d.y < 0 ? 2U : 0U) | (d.z < 0 ? 1U : 0U);
            key = (octant << 27U) | (key >> 3U);
        }
        keys.push_back(key);
    }
    return keys;
}

std::vector<std::uint32_t> keys_by_direction(std::span<const Ray> rays) {
    std::vector<std::uint32_t> keys;
    keys.reserve(rays.size());
    for (const Ray& ray : rays)
        keys.push_back(key_of_direction(ray.direction));
    return keys;
}

std::vector<std::uint32_t> keys_across_direction(std::span<const Ray> rays) {
    const auto first = std::find_if(rays.begin(), rays.end(), is_valid);
    if (first == rays.end()) return std::vector<std::uint32_t>(rays.size());
    const Frame frame = frame_along(to_double(first->direction));
    const Vec3 right = to_float(frame.right);
    const Vec3 up = to_float(frame.up);
    constexpr float infinity = std::numeric_limits<float>::infinity();
    Vec3 lo{infinity, infinity, 0};
    Vec3 hi{-infinity, -infinity, 0};
    for (const Ray& ray : rays) {
        const Vec3 at{dot(right, ray.origin), dot(up, ray.origin), 0};
        lo = min(lo, at);
        hi = max(hi, at);
    }
    constexpr float steps = 32768;
    const Vec3 scale{inverse_or_zero(hi.x - lo.x), inverse_or_zero(hi.y - lo.y), 0};
    std::vector<std::uint32_t> keys;
    keys.reserve(rays.size());
    for (const Ray& ray : rays) {
        const std::uint32_t x = step_of(dot(right, ray.origin), lo.x, scale.x, steps);
        const std::uint32_t y = step_of(dot(up, ray.origin), lo.y, scale.y, steps);
        keys.push_back((spread_by_2(x) << 1U) | spread_by_2(y));
    }
    return keys;
}

std::vector<std::uint32_t> keys_of(std::span<const Ray> rays, RayOrder order) {
    switch (order) {
    case RayOrder::origin:
        return keys_by_origin(rays, false);
    case RayOrder::octant_origin:
        return keys_by_origin(rays, true);
    case RayOrder::direction:
        return keys_by_direction(rays);
    case RayOrder::across_direction:
        break;
    }
    return keys_across_direction(rays);
}

struct Keyed {
    std::uint32_t key;
    std::uint32_t place;
};

/// One pass of the radix sort: by the ten bits from `shift` on, stable.
void sort_by_digit(const std::vector<Keyed>& from, std::vector<Keyed>& to, std::uint32_t shift) {
    constexpr std::uint32_t mask = 1023;
    std::array<std::uint32_t, mask + 1> starts{};
    for (const Keyed& item : from)
        ++starts[(item.key >> shift) & mask];
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts)
        sum += std::exchange(start, sum);
    for (const Keyed& item : from)
        to[starts[(item.key >> shift) & mask]++] = item;
}

} // namespace

std::string_view name_of(RayOrder order) {
    switch (order) {
    case RayOrder::origin:
        return "origin";
    case RayOrder::octant_origin:
        return "octant_origin";
    case RayOrder::direction:
        return "direction";
    case RayOrder::across_direction:
        break;
    }
    return "across_direction";
}

std::vector<std::uint32_t> sorted_places(std::span<const Ray> rays, RayOrder order) {
    if (rays.size() >= std::numeric_limits<std::uint32_t>::max())
        throw Error("sorted places: at most 2^32 - 2 rays");
    const std::vector<std::uint32_t> keys = keys_of(rays, order);
    std::vector<Keyed> items(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
        items[i] = {keys[i], static_cast<std::uint32_t>(i)};
    std::vector<Keyed> other(rays.size());
    for (const std::uint32_t shift : {0U, 10U, 20U}) {
        sort_by_digit(items, other, shift);
        items.swap(other);
    }
    std::vector<std::uint32_t> places;
    places.reserve(items.size());
    for (const Keyed& item : items)
        places.push_back(item.place);
    return places;
}

} // namespace raywise
