// Pictures in memory: rows of 8-bit colors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace raywise {

/// sRGB, 8 bits a channel.
struct Rgb {
    std::uint8_t red = 0;
    std::uint8_t green = 0;
    std::uint8_t blue = 0;

    friend constexpr bool operator==(const Rgb&, const Rgb&) = default;
};

/// Rows from the top, pixels from the left.
class Image {
public:
    Image() = default;

    /// width, height in [0, 32768]; throws Error (ErrorKind::limit) outside.
    Image(int width, int height, Rgb background = {255, 255, 255});

    [[nodiscard]] int width() const { return width_; }

    [[nodiscard]] int height() const { return height_; }

    /// 0 <= x < width, 0 <= y < height.
    [[nodiscard]] Rgb& at(int x, int y) { return pixels_[index(x, y)]; }

    [[nodiscard]] const Rgb& at(int x, int y) const { return pixels_[index(x, y)]; }

private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }

    int width_ = 0;
    int height_ = 0;
    std::vector<Rgb> pixels_;
};

/// Fills the part of the rectangle that lies on the image.
void fill(Image& image, int x, int y, int width, int height, Rgb color);

/// Copies `source` with its upper left corner at (x, y); what lies outside is cut off.
void paste(Image& image, const Image& source, int x, int y);

/// Height of a line of text, spacing included, at scale 1.
inline constexpr int text_height = 9;

/// Writes printable ASCII with a built-in font of 5 x 7 pixels, each `scale` >= 1 pixels wide, from
/// the upper left corner (x, y); other bytes appear as '?'. What lies outside the image is cut off.
void draw_text(Image& image, int x, int y, std::string_view text, Rgb color, int scale = 1);

/// In pixels, as `draw_text` draws it.
[[nodiscard]] int text_width(std::string_view text, int scale = 1);

} // namespace raywise
