// Heat maps: numbers of a grid of rays as colors of one shared scale. The colors are viridis, whose
// lightness rises evenly, so equal steps look equal, also in gray and to color-blind eyes.
// [Smith15]
#pragma once

#include <raywise/io/image.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace raywise {

/// One number per pixel, rows from the top; NaN where there is none (drawn gray).
struct HeatMap {
    std::string title; ///< what is drawn, in a few words
    int width = 0;     ///< in cells
    int height = 0;
    std::vector<float> values; ///< width * height of them
};

/// Which numbers get the first and the last color; numbers beyond get the nearer one of them.
struct ColorScale {
    double low = 0;
    double high = 1;  ///< > low
    std::string unit; ///< written at the scale bar, such as "cost per ray (box tests)"
};

/// The color at `share` of the scale, clamped to [0, 1]; NaN gives gray.
[[nodiscard]] Rgb viridis(double share);

/// From zero to a round number not below the 99.5th percentile of all finite values, so that one
/// stray ray does not darken every picture; [0, 1] when there are none.
[[nodiscard]] ColorScale shared_scale(std::span<const HeatMap> maps, std::string unit);

/// Mean of the finite values; NaN when there are none.
[[nodiscard]] double mean_value(const HeatMap& map);

/// The map with its title above and the scale bar with its numbers below; each cell is drawn as a
/// square of `cell_pixels` >= 1. Throws Error if the number of values does not fit the size.
[[nodiscard]] Image draw(const HeatMap& map, const ColorScale& scale, int cell_pixels = 2);

/// All maps side by side in at most `columns` >= 1 columns, under one title and above one scale
/// bar.
[[nodiscard]] Image draw_contact_sheet(
    std::span<const HeatMap> maps,
    const ColorScale& scale,
    const std::string& title,
    int columns = 2,
    int cell_pixels = 2
);

} // namespace raywise
