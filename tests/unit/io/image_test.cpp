// Oracle: pixels counted by hand.
#include <raywise/io/image.hpp>

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

namespace raywise {
namespace {

constexpr Rgb white{255, 255, 255};
constexpr Rgb black{0, 0, 0};

int count(const Image& image, Rgb color) {
    int found = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            found += image.at(x, y) == color ? 1 : 0;
    return found;
}

TEST(Image, NewOneIsAllBackground) {
    EXPECT_EQ(count(Image(4, 3), white), 12);
    EXPECT_EQ(Image().width(), 0);
}

TEST(Image, SizesOutsideTheLimitAreRefused) {
    EXPECT_THROW(Image(-1, 5), Error);
    EXPECT_THROW(Image(5, 1 << 20), Error);
}

TEST(Fill, IsCutAtTheImage) {
    Image image(4, 4);
    fill(image, -1, -1, 3, 3, black);
    EXPECT_EQ(count(image, black), 4);
    fill(image, 10, 10, 5, 5, black);
    EXPECT_EQ(count(image, black), 4);
}

TEST(Paste, IsCutAtTheImage) {
    Image image(4, 4);
    paste(image, Image(3, 3, black), -1, 2);
    EXPECT_EQ(count(image, black), 4);
    EXPECT_EQ(image.at(0, 2), black);
    EXPECT_EQ(image.at(2, 2), white);
}

TEST(DrawText, ScalesPixelByPixel) {
    Image small(40, 10), large(80, 20);
    draw_text(small, 0, 0, "Rays 1", black);
    draw_text(large, 0, 0, "Rays 1", black, 2);
    EXPECT_GT(count(small, black), 20);
    EXPECT_EQ(count(large, black), 4 * count(small, black));
}

TEST(DrawText, AMinusIsFivePixelsAndASpaceNone) {
    Image image(20, 10);
    draw_text(image, 1, 1, " -", black);
    EXPECT_EQ(count(image, black), 5);
}

TEST(DrawText, OtherBytesAppearAsQuestionMarks) {
    Image odd(10, 10), question(10, 10);
    draw_text(odd, 0, 0, "\xFF", black);
    draw_text(question, 0, 0, "?", black);
    for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 10; ++x)
            EXPECT_EQ(odd.at(x, y), question.at(x, y));
}

TEST(TextWidth, IsSixPixelsACharacterWithoutTheLastGap) {
    EXPECT_EQ(text_width(""), 0);
    EXPECT_EQ(text_width("ab"), 11);
    EXPECT_EQ(text_width("ab", 3), 33);
}

} // namespace
} // namespace raywise
