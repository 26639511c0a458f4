#include "scene_writer.hpp"

namespace raywise::io_detail {

std::string write_glb(const Scene& scene) {
    return scene.name;
}

} // namespace raywise::io_detail
