// Scenes made of numbers: the thesis's random triangles, and places of any size to try things on.
// After [Falcone24] for the random triangles.
#pragma once

#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <cstdint>

namespace raywise {

/// Independent small triangles: v0 uniform in [0, 10)^3, v1 = v0 + U[-1, 1)^3, v2 = v1 + U[-1,
/// 1)^3, coordinates drawn in the order x, y, z from one std::mt19937 stream, each as lo + (hi -
/// lo) * u in double, u from two words, low first. `skipped` triangles are drawn and dropped first:
/// the thesis drew Random100 = (100, 1) and went on to Random1000 = (1000, 1, 100). [Falcone24]
/// count <= max_triangles / 3; throws Error beyond.
[[nodiscard]] Scene
generate_random_triangles(std::size_t count, std::uint32_t seed = 1, std::size_t skipped = 0);

/// How large, and which of its kind.
struct GenerateParams {
    std::size_t triangles = 100'000; ///< about as many; in [100, 100'000'000]
    std::uint64_t seed = 1;
};

// Each of the following gives the same bytes on any platform for the same parameters: numbers come
// from Rng and from +, -, *, / and sqrt alone; sines are computed here. Up is +y, units are meters,
// the floor is at y = 0. The triangle count is within a quarter of the one asked for, or of the
// smallest that the scene can have: about 18,000 for the courtyard, below 1,000 for the others.
// Throws Error when a parameter is out of its range.

/// A paved courtyard of 24 m x 16 m with a fountain, two-storey arcades of round arches on columns
/// and tiled roofs: the embedded demo scene. Has a sun (directional), a lamp (point light) under
/// the arcade and a camera.
[[nodiscard]] Scene generate_courtyard(const GenerateParams& params = {});

/// Blocks of houses with window frames and gabled or flat roofs along streets; a sun and a camera.
[[nodiscard]] Scene generate_city(const GenerateParams& params = {});

/// Trees of trunks, branches and many small leaves on uneven ground: overlapping, with empty space
/// in between; a sun and a camera.
[[nodiscard]] Scene generate_forest(const GenerateParams& params = {});

/// A height field over 1 km x 1 km, two triangles a cell; a sun and a camera.
[[nodiscard]] Scene generate_terrain(const GenerateParams& params = {});

/// Clusters of tessellated spheres of sizes over two orders of magnitude, far apart: the density of
/// triangles varies by orders of magnitude; a point light at a cluster's middle and a camera.
[[nodiscard]] Scene generate_spheres(const GenerateParams& params = {});

} // namespace raywise
