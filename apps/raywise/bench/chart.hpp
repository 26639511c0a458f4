// The ratios of a bench as a picture: one bar per scene and class of rays.
#pragma once

#include "bench/rows.hpp"

#include <span>
#include <string>

namespace raywise::app {

/// An SVG image: a panel for each peer, a group of bars for each scene, a logarithmic scale with a
/// line where both sides are equally fast, and a mark on each bar where its goal stands. Rows that
/// were not timed are left out. `caption` stands under it.
[[nodiscard]] std::string draw_chart(std::span<const BenchRow> rows, const std::string& caption);

} // namespace raywise::app
