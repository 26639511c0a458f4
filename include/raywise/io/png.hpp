// Pictures as PNG files. [PNG03]
#pragma once

#include <raywise/io/image.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace raywise {

/// The bytes of an 8-bit RGB PNG file without time stamps: equal images give equal bytes. Throws
/// Error for an image without pixels.
[[nodiscard]] std::vector<std::byte> encode_png(const Image& image);

/// Writes the file whole or not at all, as `write_file_atomically` does.
void write_png(const std::string& path, const Image& image);

} // namespace raywise
