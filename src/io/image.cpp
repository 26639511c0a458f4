#include <raywise/io/image.hpp>

#include "io/bitmap_font.hpp"

#include <raywise/core/error.hpp>

#include <algorithm>
#include <cstddef>
#include <string>

namespace raywise {

namespace {

constexpr int size_limit = 32768;
constexpr int glyph_rows = 7;
constexpr int advance = 6; // five columns and a gap

int checked_side(int side) {
    if (side < 0 || side > size_limit)
        throw Error(
            ErrorKind::limit,
            {},
            nowhere(),
            "image side of " + std::to_string(side) + " pixels is outside 0.." +
                std::to_string(size_limit)
        );
    return side;
}

void draw_glyph(Image& image, int x, int y, char character, Rgb color, int scale) {
    const detail::Glyph& columns = detail::glyph(character);
    for (std::size_t column = 0; column < columns.size(); ++column)
        for (int row = 0; row < glyph_rows; ++row)
            if (((static_cast<unsigned>(columns[column]) >> static_cast<unsigned>(row)) & 1U) != 0)
                fill(
                    image,
                    x + static_cast<int>(column) * scale,
                    y + row * scale,
                    scale,
                    scale,
                    color
                );
}

} // namespace

Image::Image(int width, int height, Rgb background)
    : width_(checked_side(width))
    , height_(checked_side(height))
    , pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), background) {}

void fill(Image& image, int x, int y, int width, int height, Rgb color) {
    const int right = std::min(x + width, image.width());
    const int bottom = std::min(y + height, image.height());
    for (int row = std::max(y, 0); row < bottom; ++row)
        for (int column = std::max(x, 0); column < right; ++column)
            image.at(column, row) = color;
}

void paste(Image& image, const Image& source, int x, int y) {
    const int right = std::min(source.width(), image.width() - x);
    const int bottom = std::min(source.height(), image.height() - y);
    for (int row = std::max(0, -y); row < bottom; ++row)
        for (int column = std::max(0, -x); column < right; ++column)
            image.at(x + column, y + row) = source.at(column, row);
}

void draw_text(Image& image, int x, int y, std::string_view text, Rgb color, int scale) {
    for (const char character : text) {
        draw_glyph(image, x, y, character, color, scale);
        x += advance * scale;
    }
}

int text_width(std::string_view text, int scale) {
    return text.empty() ? 0 : (static_cast<int>(text.size()) * advance - 1) * scale;
}

} // namespace raywise
