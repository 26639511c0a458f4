#include "text_number.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>

namespace raywise::io_detail {

namespace {

/// A plus sign is common in files, but from_chars takes none.
std::string_view without_plus(std::string_view token) {
    if (token.size() >= 2 && token[0] == '+' && token[1] != '-' && token[1] != '+')
        token.remove_prefix(1);
    return token;
}

/// What a decimal number rounds to that from_chars found too large or too small to represent. The
/// decimal exponent of its first nonzero digit tells which.
double beyond_range(std::string_view token) {
    const bool negative = token[0] == '-';
    const std::size_t mark = token.find_first_of("eE");
    std::int64_t exponent = 0;
    bool is_huge_exponent = false;
    if (mark != std::string_view::npos) {
        const std::string_view digits = without_plus(token.substr(mark + 1));
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
        is_huge_exponent = error == std::errc::result_out_of_range;
        if (is_huge_exponent) exponent = digits[0] == '-' ? -1 : 1;
    }
    const std::string_view mantissa = token.substr(0, mark);
    const std::size_t first = mantissa.find_first_of("123456789");
    const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
    const auto position = static_cast<std::int64_t>(point) - static_cast<std::int64_t>(first);
    const bool is_large = is_huge_exponent ? exponent > 0 : exponent + position > 0;
    const double size = is_large ? std::numeric_limits<double>::infinity() : 0.0;
    return negative ? -size : size;
}

template <class Real>
std::optional<Real> parse_real(std::string_view token) {
    token = without_plus(token);
    Real value = 0;
    const char* last = token.data() + token.size();
    const auto [end, error] = std::from_chars(token.data(), last, value);
    if (error == std::errc::invalid_argument || end != last) return std::nullopt;
    if (error == std::errc::result_out_of_range) return static_cast<Real>(beyond_range(token));
    // "nan(...)" is a token of C, not of any scene format.
    if (std::isnan(value) && token.find('(') != std::string_view::npos) return std::nullopt;
    return value;
}

} // namespace

std::optional<float> parse_float(std::string_view token) {
    return parse_real<float>(token);
}

std::optional<double> parse_double(std::string_view token) {
    return parse_real<double>(token);
}

std::optional<std::int64_t> parse_integer(std::string_view token) {
    token = without_plus(token);
    std::int64_t value = 0;
    const char* last = token.data() + token.size();
    const auto [end, error] = std::from_chars(token.data(), last, value);
    if (error != std::errc() || end != last) return std::nullopt;
    return value;
}

std::string_view next_token(std::string_view& line) {
    const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
    line.remove_prefix(first);
    const std::size_t size = std::min(line.find_first_of(" \t"), line.size());
    const std::string_view token = line.substr(0, size);
    line.remove_prefix(size);
    return token;
}

} // namespace raywise::io_detail
