// Whole files, safely: only regular files are read, and what is written is whole or not there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace raywise {

/// The bytes of a regular file; a directory, pipe or device is refused without being read. Throws
/// Error of kind io when it cannot be read, of kind limit when it is larger than `max_bytes`.
[[nodiscard]] std::string read_file(
    const std::filesystem::path& path,
    std::size_t max_bytes = std::numeric_limits<std::size_t>::max()
);

/// Writes the bytes under a temporary name beside `path` and renames: at any moment `path` is what
/// it was or what it will be. A device or a pipe is written directly. Its folder must exist. Throws
/// Error of kind io; nothing is left behind then.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// The file `reference` of a document in `folder`: relative, without "..", and within the folder
/// even after symbolic links are followed. Throws Error naming `document` otherwise.
[[nodiscard]] std::filesystem::path resolve_inside(
    const std::filesystem::path& folder,
    std::string_view reference,
    const std::filesystem::path& document
);

} // namespace raywise
