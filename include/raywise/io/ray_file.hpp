// Sets of rays and hits in files that numpy reads: rays as .npy, hits as .npz.
#pragma once

#include <raywise/distribution/measured.hpp>
#include <raywise/geometry/ray.hpp>

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace raywise {

/// Rays of a file: .npy of shape (N, 8), or (N, 6) with t_min = 0 and t_max = +inf, float32 or
/// float64, either byte order, C or Fortran order; columns origin, direction, t_min, t_max. Of an
/// .npz (stored or deflated) the member `rays`. Every ray must be valid (`is_valid`). Throws Error
/// with the byte and the reason.
[[nodiscard]] std::vector<Ray> load_rays(const std::filesystem::path& path);

/// Writes rays as .npy, shape (N, 8), float32, little-endian, in one step. `excluded` is not
/// stored. Throws Error when the file cannot be written.
void save_rays(const std::filesystem::path& path, std::span<const Ray> rays);

/// Rays with weights, for a measured distribution: as load_rays; of an .npz the member `weights`,
/// of shape (N), too. Weights are finite and >= 0, and 1 where there are none.
[[nodiscard]] std::vector<RecordedRay> load_recorded_rays(const std::filesystem::path& path);

/// Writes rays and weights as .npz (members stored): `rays` float32, `weights` float64.
void save_recorded_rays(const std::filesystem::path& path, std::span<const RecordedRay> rays);

/// Writes one row per ray as .npz (members stored): t float32, prim uint32, u and v float32, front
/// bool. A miss is t = +inf, prim = 0xFFFFFFFF and zeros.
void save_hits(const std::filesystem::path& path, std::span<const std::optional<Hit>> hits);

/// Reads what `save_hits` wrote, stored or deflated. Throws Error with the byte and the reason.
[[nodiscard]] std::vector<std::optional<Hit>> load_hits(const std::filesystem::path& path);

} // namespace raywise
