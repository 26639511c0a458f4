// "Did you mean": the known word that a mistyped one is closest to.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace raywise {

/// The known word with the fewest insertions, deletions, replacements and swaps of neighbors
/// [Damerau64] from `word`; the first of equals; nullopt when all differ in more than a third of
/// their letters (at least two are allowed).
[[nodiscard]] std::optional<std::string>
nearest_word(std::string_view word, std::span<const std::string> known);

/// "; did you mean 'x'?" or nothing.
[[nodiscard]] std::string did_you_mean(std::string_view word, std::span<const std::string> known);

} // namespace raywise
