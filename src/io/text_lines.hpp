// The lines of a text, numbered from 1. LF and CR LF end a line; CR alone is refused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace raywise::io_detail {

/// Hands out one line after the other, without its end.
class TextLines {
public:
    explicit TextLines(std::string_view text) : text_(text) {}

    /// The next line; nullopt at the end. A trailing line end starts no further line.
    std::optional<std::string_view> next();

    /// Number of the line that `next` gave last.
    [[nodiscard]] std::uint64_t number() const { return number_; }

    /// Bytes handed out so far, line ends included.
    [[nodiscard]] std::size_t offset() const { return offset_; }

private:
    std::string_view text_;
    std::size_t offset_ = 0;
    std::uint64_t number_ = 0;
};

/// Why the line is no text (a CR that ends no line, a NUL or another control character), or empty
/// when it is.
[[nodiscard]] std::string_view control_character_in(std::string_view line);

} // namespace raywise::io_detail
