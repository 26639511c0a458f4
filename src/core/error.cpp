#include <raywise/core/error.hpp>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace raywise {

namespace {

constexpr std::size_t message_limit = 300;

/// Length of the valid UTF-8 sequence that starts `text`, or 0.
std::size_t utf8_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned lead = byte(0);
    std::size_t length = 0;
    if (lead < 0x80)
        length = 1;
    else if (lead >= 0xC2 && lead < 0xE0)
        length = 2;
    else if (lead >= 0xE0 && lead < 0xF0)
        length = 3;
    else if (lead >= 0xF0 && lead < 0xF5)
        length = 4;
    if (length == 0 || length > text.size()) return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xC0U) != 0x80U) return 0;
    return length;
}

std::string located(std::string_view path, Place place, std::string_view reason) {
    // The path gives way before the reason does: it is cut at its front, where it says least.
    constexpr std::size_t path_limit = 120;
    std::string name(path);
    if (name.size() > path_limit) name = "..." + name.substr(name.size() - path_limit);
    std::string text;
    if (!name.empty()) text += name + ":";
    if (place.unit == Place::Unit::line) text += std::to_string(place.number) + ":";
    if (place.unit == Place::Unit::byte) {
        if (!text.empty()) text += " ";
        text += "byte " + std::to_string(place.number) + ":";
    }
    if (!text.empty()) text += " ";
    text += reason;
    return escaped(text, message_limit);
}

} // namespace

Error::Error(std::string_view reason) : Error(ErrorKind::input, {}, nowhere(), reason) {}

Error::Error(std::string_view path, Place place, std::string_view reason)
    : Error(ErrorKind::input, path, place, reason) {}

Error::Error(ErrorKind kind, std::string_view path, Place place, std::string_view reason)
    : std::runtime_error(located(path, place, reason)), kind_(kind), path_(path), place_(place) {}

std::string escaped(std::string_view text, std::size_t limit) {
    constexpr std::string_view digits = "0123456789abcdef";
    constexpr std::string_view ellipsis = "...";
    std::string result;
    std::size_t fits = 0; // the longest prefix of `result` that leaves room for the ellipsis
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        const auto first = static_cast<unsigned char>(text[0]);
        if (length == 0 || first < 0x20 || first == 0x7F) {
            result += {'\\', 'x', digits[first >> 4U], digits[first & 15U]};
            text.remove_prefix(1);
        } else {
            result += text.substr(0, length);
            text.remove_prefix(length);
        }
        if (result.size() + ellipsis.size() <= limit) fits = result.size();
        if (result.size() > limit) return result.substr(0, fits).append(ellipsis);
    }
    return result;
}

} // namespace raywise
