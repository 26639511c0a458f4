// Oracles: the published colors of viridis, the lightness of CIE L*, and libpng's own reader.
#include <raywise/io/heat_map.hpp>

#include <raywise/core/error.hpp>
#include <raywise/io/png.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace raywise {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

double linear(std::uint8_t channel) {
    const double value = channel / 255.0;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

/// CIE L*, in [0, 100].
double lightness(Rgb color) {
    const double y =
        0.2126 * linear(color.red) + 0.7152 * linear(color.green) + 0.0722 * linear(color.blue);
    return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

TEST(Viridis, StartsInTheMiddleAndEndsAtThePublishedColors) {
    EXPECT_EQ(viridis(0), (Rgb{68, 1, 84}));
    EXPECT_EQ(viridis(0.5), (Rgb{33, 145, 140}));
    EXPECT_EQ(viridis(1), (Rgb{253, 231, 37}));
}

TEST(Viridis, LightnessRisesEvenly) {
    const double first = lightness(viridis(0)), last = lightness(viridis(1));
    for (int i = 0; i <= 100; ++i) {
        const double share = i / 100.0;
        EXPECT_NEAR(lightness(viridis(share)), first + share * (last - first), 2.5) << share;
    }
}

TEST(Viridis, ClampsAndShowsNanAsGray) {
    EXPECT_EQ(viridis(-3), viridis(0));
    EXPECT_EQ(viridis(std::numeric_limits<double>::infinity()), viridis(1));
    EXPECT_EQ(viridis(std::nan("")), (Rgb{128, 128, 128}));
}

TEST(SharedScale, HoldsTheValuesOfAllMapsAndIgnoresNan) {
    const std::vector<HeatMap> maps = {
        {.title = "a", .width = 2, .height = 1, .values = {1, nan}},
        {.title = "b", .width = 2, .height = 1, .values = {37, 2}},
    };
    const ColorScale scale = shared_scale(maps, "tests");
    EXPECT_EQ(scale.low, 0);
    EXPECT_EQ(scale.high, 2); // the rank 0.995 of three values is the second
    EXPECT_EQ(scale.unit, "tests");
}

TEST(SharedScale, IsNotStretchedByOneStrayRay) {
    HeatMap map{.title = "", .width = 1000, .height = 1, .values = std::vector<float>(1000, 38.0F)};
    map.values[500] = 1e9F;
    EXPECT_EQ(shared_scale({&map, 1}, "").high, 40);
}

TEST(SharedScale, OfNothingOrOfZerosIsTheUnitInterval) {
    const HeatMap zeros{.title = "", .width = 2, .height = 1, .values = {0, 0}};
    EXPECT_EQ(shared_scale({}, "").high, 1);
    EXPECT_EQ(shared_scale({&zeros, 1}, "").high, 1);
}

TEST(MeanValue, IsOverTheFiniteValues) {
    EXPECT_EQ(mean_value({.title = "", .width = 3, .height = 1, .values = {1, nan, 3}}), 2);
    EXPECT_TRUE(std::isnan(mean_value({.title = "", .width = 1, .height = 1, .values = {nan}})));
}

bool shows(const Image& image, Rgb color) {
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            if (image.at(x, y) == color) return true;
    return false;
}

TEST(DrawHeatMap, ShowsEachCellInItsColor) {
    const HeatMap map{.title = "t", .width = 2, .height = 1, .values = {0, nan}};
    const Image image = draw(map, {.low = 0, .high = 4, .unit = "u"}, 3);
    EXPECT_TRUE(shows(image, viridis(0)));
    EXPECT_TRUE(shows(image, viridis(1))) << "the end of the scale bar";
    EXPECT_TRUE(shows(image, viridis(std::nan(""))));
}

TEST(DrawHeatMap, RefusesValuesThatDoNotFitTheSize) {
    EXPECT_THROW((void)draw({.title = "", .width = 2, .height = 2, .values = {1}}, {}), Error);
    EXPECT_THROW((void)draw({.title = "", .width = 1, .height = 1, .values = {1}}, {}, 0), Error);
}

TEST(DrawHeatMap, WithoutCellsOrWithLongTitlesIsStillAPicture) {
    EXPECT_GT(draw({}, {}).width(), 0);
    EXPECT_GT(
        draw({.title = std::string(500, 'x'), .width = 0, .height = 0, .values = {}}, {}).height(),
        0
    );
}

TEST(DrawContactSheet, HoldsAllPanelsAndIsPossibleWithoutAny) {
    const std::vector<HeatMap> maps(
        3, {.title = "m", .width = 20, .height = 10, .values = std::vector<float>(200, 1)}
    );
    const Image three = draw_contact_sheet(maps, {}, "title", 2);
    const Image one = draw_contact_sheet({maps.data(), 1}, {}, "title", 2);
    EXPECT_GT(three.width(), one.width());
    EXPECT_GT(three.height(), one.height());
    EXPECT_GT(draw_contact_sheet({}, {}, "nothing").width(), 0);
    EXPECT_THROW((void)draw_contact_sheet(maps, {}, "", 0), Error);
}

} // namespace
} // namespace raywise
