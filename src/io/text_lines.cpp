#include "text_lines.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>

namespace raywise::io_detail {

std::optional<std::string_view> TextLines::next() {
    if (offset_ == text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n', offset_), text_.size());
    std::string_view line = text_.substr(offset_, end - offset_);
    offset_ = std::min(end + 1, text_.size());
    ++number_;
    // A CR belongs to the line's end only before an LF.
    if (end < text_.size() && !line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

std::string_view control_character_in(std::string_view line) {
    for (const char c : line) {
        if (c == '\r') return "a carriage return without a line feed";
        if (static_cast<unsigned char>(c) < 0x20 && c != '\t') return "a control character in text";
    }
    return {};
}

} // namespace raywise::io_detail
