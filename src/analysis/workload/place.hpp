// Where the eyes, suns and lamps of a workload are.
#pragma once

#include <raywise/analysis/ray_workload.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace raywise::workload_detail {

inline constexpr double degree = std::numbers::pi / 180;

/// Streams of random numbers that must not meet.
enum class Stream : std::uint64_t { eye = 1, sun, lamp, tile, pixel, bounce, light, lens };

[[nodiscard]] inline std::uint64_t
seed_of(std::uint64_t seed, Stream stream, std::size_t number = 0) {
    return mix_bits(seed * 0x100 + static_cast<std::uint64_t>(stream)) + number;
}

/// The room of a scene.
struct Place {
    const Scene* scene = nullptr;
    Aabb box;  ///< a little wider than the scene
    Frame sky; ///< forward is up
    Vec3d middle;
    double diagonal = 0;
};

/// Throws Error for a scene without extent.
[[nodiscard]] Place place_of(const Scene& scene, const WorkloadParams& params);

/// The direction at an elevation above the horizon.
[[nodiscard]] Vec3d toward_sky(const Place& place, double azimuth, double elevation);

/// Eyes and lamps with even numbers stand outside, suns with even numbers are high.
[[nodiscard]] inline bool is_outside(std::size_t number) {
    return number % 2 == 0;
}

/// A place for an eye or a lamp.
[[nodiscard]] Vec3d standpoint(const Place& place, std::uint64_t seed, std::size_t number);

} // namespace raywise::workload_detail
