#include <raywise/io/png.hpp>

#include <raywise/core/error.hpp>
#include <raywise/io/files.hpp>
#include <raywise/io/image.hpp>

#include <png.h>

#include <cstddef>
#include <string>
#include <vector>

namespace raywise {

namespace {

static_assert(sizeof(Rgb) == 3, "rows are handed to libpng as they are");

} // namespace

std::vector<std::byte> encode_png(const Image& image) {
    if (image.width() == 0 || image.height() == 0)
        throw Error("an image without pixels cannot be a PNG file");
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(image.width());
    header.height = static_cast<png_uint_32>(image.height());
    header.format = PNG_FORMAT_RGB;

    std::vector<std::byte> bytes(PNG_IMAGE_PNG_SIZE_MAX(header));
    png_alloc_size_t size = bytes.size();
    if (png_image_write_to_memory(&header, bytes.data(), &size, 0, &image.at(0, 0), 0, nullptr) ==
        0)
        throw Error(
            ErrorKind::limit,
            {},
            nowhere(),
            std::string("PNG: ") + static_cast<const char*>(header.message)
        );
    bytes.resize(size);
    return bytes;
}

void write_png(const std::string& path, const Image& image) {
    const std::vector<std::byte> bytes = encode_png(image);
    write_file_atomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

} // namespace raywise
