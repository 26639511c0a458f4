#include <raywise/io/heat_map.hpp>

#include <raywise/core/error.hpp>
#include <raywise/io/image.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace raywise {

namespace {

constexpr Rgb black{0, 0, 0};
constexpr Rgb gray{128, 128, 128};
constexpr int margin = 8;
constexpr int bar_height = 12;
constexpr int tick_height = 4;
constexpr int text_scale = 2;
constexpr int line_height = text_height * text_scale;
constexpr int tick_count = 5;
constexpr int smallest_panel = 240; // pixels: room for the numbers of the scale bar

struct Color {
    double red, green, blue;
};

// Nine colors of viridis at equal steps; between them straight lines stay within 2/255 of the
// original.
constexpr std::array<Color, 9> control_points = {{
    {68, 1, 84},
    {71, 45, 123},
    {59, 82, 139},
    {44, 114, 142},
    {33, 145, 140},
    {40, 174, 128},
    {94, 201, 98},
    {173, 220, 48},
    {253, 231, 37},
}};

std::uint8_t channel(double value) {
    return static_cast<std::uint8_t>(std::lround(value));
}

/// A small whole number times a power of ten, not below `value` > 0.
double round_number_above(double value) {
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double factor : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
        if (factor * power >= value) return factor * power;
    return 10 * power;
}

std::vector<float> finite_values(std::span<const HeatMap> maps) {
    std::vector<float> values;
    for (const HeatMap& map : maps)
        for (const float value : map.values)
            if (std::isfinite(value)) values.push_back(value);
    return values;
}

std::string shortened(const std::string& text, int width) {
    const auto fits = static_cast<std::size_t>(std::max(width / (6 * text_scale), 3));
    return text.size() <= fits ? text : text.substr(0, fits - 2) + "..";
}

Image draw_cells(const HeatMap& map, const ColorScale& scale, int cell_pixels) {
    const auto width = static_cast<std::size_t>(std::max(map.width, 0));
    if (map.values.size() != width * static_cast<std::size_t>(std::max(map.height, 0)))
        throw Error("heat map: the number of values does not fit its width and height");
    if (cell_pixels < 1) throw Error("heat map: cell_pixels is below 1");
    Image image(map.width * cell_pixels, map.height * cell_pixels);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const auto value = static_cast<double>(
                map.values[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)]
            );
            const Rgb color = viridis((value - scale.low) / (scale.high - scale.low));
            fill(image, x * cell_pixels, y * cell_pixels, cell_pixels, cell_pixels, color);
        }
    return image;
}

constexpr int scale_bar_height = bar_height + tick_height + 2 * line_height + margin;

/// The colors from low to high, numbers under the ticks and the unit below.
void draw_scale_bar(Image& image, const ColorScale& scale, int x, int y, int width) {
    for (int column = 0; column < width; ++column)
        fill(image, x + column, y, 1, bar_height, viridis(column / std::max(width - 1.0, 1.0)));
    for (int tick = 0; tick < tick_count; ++tick) {
        const double share = tick / (tick_count - 1.0);
        const int at = x + static_cast<int>(std::lround(share * (width - 1)));
        fill(image, at, y + bar_height, 1, tick_height, black);
        const std::string number =
            fmt::format("{:.4g}", scale.low + share * (scale.high - scale.low));
        const int room = text_width(number, text_scale);
        // Numbers stand under their tick; the outer two are pushed inside the bar.
        const int left = std::clamp(at - room / 2, x, std::max(x, x + width - room));
        draw_text(image, left, y + bar_height + tick_height + 2, number, black, text_scale);
    }
    const int unit_y = y + bar_height + tick_height + 2 + line_height;
    draw_text(image, x, unit_y, shortened(scale.unit, width), black, text_scale);
}

/// The cells under a title line with the map's mean.
Image draw_panel(const HeatMap& map, const ColorScale& scale, int cell_pixels) {
    const Image cells = draw_cells(map, scale, cell_pixels);
    const int width = std::max(cells.width(), smallest_panel);
    Image panel(width, cells.height() + 2 * line_height);
    draw_text(panel, 0, 0, shortened(map.title, width), black, text_scale);
    const double mean = mean_value(map);
    const std::string caption =
        std::isnan(mean) ? std::string("no values") : fmt::format("mean {:.4g}", mean);
    draw_text(panel, 0, line_height, caption, black, text_scale);
    paste(panel, cells, 0, 2 * line_height);
    return panel;
}

} // namespace

Rgb viridis(double share) {
    if (std::isnan(share)) return gray;
    constexpr double steps = control_points.size() - 1.0;
    const double position = std::clamp(share, 0.0, 1.0) * steps;
    const double base = std::min(std::floor(position), steps - 1);
    const double part = position - base;
    const auto index = static_cast<std::size_t>(base);
    const Color& a = control_points[index];
    const Color& b = control_points[index + 1];
    return {
        channel(a.red + part * (b.red - a.red)),
        channel(a.green + part * (b.green - a.green)),
        channel(a.blue + part * (b.blue - a.blue))
    };
}

ColorScale shared_scale(std::span<const HeatMap> maps, std::string unit) {
    std::vector<float> values = finite_values(maps);
    ColorScale scale{.low = 0, .high = 1, .unit = std::move(unit)};
    if (values.empty()) return scale;
    const std::size_t rank = (values.size() - 1) * 995 / 1000;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), at, values.end());
    if (*at > 0) scale.high = round_number_above(static_cast<double>(*at));
    return scale;
}

double mean_value(const HeatMap& map) {
    const std::vector<float> values = finite_values({&map, 1});
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    double sum = 0;
    for (const float value : values)
        sum += static_cast<double>(value);
    return sum / static_cast<double>(values.size());
}

Image draw(const HeatMap& map, const ColorScale& scale, int cell_pixels) {
    const Image panel = draw_panel(map, scale, cell_pixels);
    Image image(panel.width() + 2 * margin, panel.height() + 3 * margin + scale_bar_height);
    paste(image, panel, margin, margin);
    draw_scale_bar(image, scale, margin, panel.height() + 2 * margin, panel.width());
    return image;
}

Image draw_contact_sheet(
    std::span<const HeatMap> maps,
    const ColorScale& scale,
    const std::string& title,
    int columns,
    int cell_pixels
) {
    if (columns < 1) throw Error("heat map: a contact sheet needs at least one column");
    std::vector<Image> panels;
    int width = smallest_panel, height = 0;
    for (const HeatMap& map : maps) {
        panels.push_back(draw_panel(map, scale, cell_pixels));
        width = std::max(width, panels.back().width());
        height = std::max(height, panels.back().height());
    }
    const int count = static_cast<int>(panels.size());
    const int across = std::clamp(count, 1, columns);
    const int down = (count + across - 1) / across;
    const int inner_width = across * (width + margin) - margin;
    const int top = 2 * margin + line_height;

    Image sheet(
        inner_width + 2 * margin, top + down * (height + margin) + margin + scale_bar_height
    );
    draw_text(sheet, margin, margin, shortened(title, inner_width), black, text_scale);
    for (int i = 0; i < count; ++i) {
        const int x = margin + (i % across) * (width + margin);
        const int y = top + (i / across) * (height + margin);
        paste(sheet, panels[static_cast<std::size_t>(i)], x, y);
    }
    draw_scale_bar(sheet, scale, margin, top + down * (height + margin), inner_width);
    return sheet;
}

} // namespace raywise
