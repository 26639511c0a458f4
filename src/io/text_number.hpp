// Numbers in text, independent of the locale: decimal only, the whole token or nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace raywise::io_detail {

/// A decimal number rounded to float; infinite beyond its range; "nan" and "inf" in any case are
/// read as such. nullopt for anything else: an empty token, hexadecimal, a comma, trailing letters.
[[nodiscard]] std::optional<float> parse_float(std::string_view token);

/// The same for double.
[[nodiscard]] std::optional<double> parse_double(std::string_view token);

/// A decimal integer; nullopt when it does not fit or anything else is in the token.
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view token);

/// Takes the next token off the front of `line`: characters up to a space or tab. Empty at the end.
[[nodiscard]] std::string_view next_token(std::string_view& line);

} // namespace raywise::io_detail
