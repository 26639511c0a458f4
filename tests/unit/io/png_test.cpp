// Oracle: libpng's reader.
#include <raywise/io/png.hpp>

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>
#include <png.h>

#include <string>

namespace raywise {
namespace {

TEST(Png, ReadsBackAsTheSamePixels) {
    Image image(5, 3);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x)
            image.at(x, y) = {
                static_cast<std::uint8_t>(50 * x), static_cast<std::uint8_t>(100 * y), 7
            };
    const std::vector<std::byte> bytes = encode_png(image);

    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()), 0);
    ASSERT_EQ(header.width, 5U);
    ASSERT_EQ(header.height, 3U);
    header.format = PNG_FORMAT_RGB;
    std::vector<Rgb> pixels(15);
    ASSERT_NE(png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr), 0);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x)
            EXPECT_EQ(pixels[static_cast<std::size_t>(5 * y + x)], image.at(x, y));
}

TEST(Png, EqualImagesGiveEqualBytes) {
    EXPECT_EQ(encode_png(Image(9, 9)), encode_png(Image(9, 9)));
}

TEST(Png, ImageWithoutPixelsIsRefused) {
    EXPECT_THROW((void)encode_png({}), Error);
    EXPECT_THROW((void)encode_png(Image(0, 7)), Error);
}

TEST(Png, UnwritablePlaceIsAnInputOutputError) {
    try {
        write_png("no such folder/x.png", Image(1, 1));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::io);
        EXPECT_NE(std::string(error.what()).find("no such folder/x.png"), std::string::npos);
    }
}

} // namespace
} // namespace raywise
