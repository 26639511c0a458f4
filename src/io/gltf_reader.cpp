#include "scene_reader.hpp"

namespace raywise::io_detail {

void read_gltf(SceneReader& reader) {
    reader.refuse(nowhere(), "this format is not read yet");
}

} // namespace raywise::io_detail
