// The one error type: what was refused, where in which file, and why. Thrown only at the doors of
// the library.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace raywise {

/// Why work could not be done. The command line maps each to an exit code (docs/cli.md).
enum class ErrorKind : std::uint8_t {
    input, ///< the caller's data or parameters are refused
    limit, ///< a resource limit would be exceeded; nothing was allocated
    io,    ///< the file system failed
};

/// A place in a file: nowhere, a line (from 1) or a byte (from 0).
struct Place {
    enum class Unit : std::uint8_t { none, line, byte };

    Unit unit = Unit::none;
    std::uint64_t number = 0;
};

[[nodiscard]] constexpr Place nowhere() {
    return {};
}

[[nodiscard]] constexpr Place at_line(std::uint64_t number) {
    return {Place::Unit::line, number};
}

[[nodiscard]] constexpr Place at_byte(std::uint64_t number) {
    return {Place::Unit::byte, number};
}

/// Bad input, an exceeded limit or a failed file. `what()` is one line of at most 300 bytes,
/// control characters escaped: "scene.obj:41: face refers to vertex 17 of 12", "scene.ply: byte
/// 120: ...", or just the reason when no file is involved.
class Error : public std::runtime_error {
public:
    /// A refusal that names no file: a parameter out of its range.
    explicit Error(std::string_view reason);

    /// A refusal of the file `path` at `place`.
    Error(std::string_view path, Place place, std::string_view reason);

    Error(ErrorKind kind, std::string_view path, Place place, std::string_view reason);

    [[nodiscard]] ErrorKind kind() const { return kind_; }

    [[nodiscard]] const std::string& path() const { return path_; }

    [[nodiscard]] Place place() const { return place_; }

private:
    ErrorKind kind_ = ErrorKind::input;
    std::string path_;
    Place place_;
};

/// `text` with control characters, and bytes that are not UTF-8, as \xNN; cut to `limit` bytes with
/// "..." at a cut.
[[nodiscard]] std::string escaped(std::string_view text, std::size_t limit = 300);

} // namespace raywise
