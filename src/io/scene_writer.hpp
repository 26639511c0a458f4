// The writers of scene formats: from a valid scene to the bytes of a file.
#pragma once

#include <raywise/scene/scene.hpp>

#include <string>

namespace raywise::io_detail {

[[nodiscard]] std::string write_ply(const Scene& scene);
[[nodiscard]] std::string write_obj(const Scene& scene);
[[nodiscard]] std::string write_stl(const Scene& scene);
[[nodiscard]] std::string write_glb(const Scene& scene);

} // namespace raywise::io_detail
