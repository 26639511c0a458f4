// The cameras of a workload: pictures of 1024 x 1024 pixels, in tiles.
#pragma once

#include "analysis/workload/place.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <cstdint>

namespace raywise::workload_detail {

inline constexpr std::uint64_t image_tiles = 64; ///< per side
inline constexpr std::uint64_t tile_pixels = 16; ///< per side
inline constexpr std::size_t tile_paths = tile_pixels * tile_pixels;

struct Eye {
    Vec3d position;
    Frame frame;
    double focus = 0; ///< depth at which a lens is sharp
};

[[nodiscard]] Eye make_eye(const Place& place, std::uint64_t seed, std::size_t number);

[[nodiscard]] Frustum view_of(const Place& place, const Eye& eye);

/// The way into the picture that a path takes, depth 1: through a random point of a tile's pixel.
[[nodiscard]] Vec3d look_along(const Eye& eye, std::uint64_t tile, std::size_t pixel, Rng& rng);

} // namespace raywise::workload_detail
