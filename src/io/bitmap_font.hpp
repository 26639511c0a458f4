// The built-in font of pictures: printable ASCII, five columns of seven pixels each.
#pragma once

#include <array>
#include <cstdint>

namespace raywise::detail {

/// Columns from the left; bit 0 is the top pixel.
using Glyph = std::array<std::uint8_t, 5>;

/// The glyph of a printable ASCII character; that of '?' for any other byte.
[[nodiscard]] const Glyph& glyph(char character);

} // namespace raywise::detail
