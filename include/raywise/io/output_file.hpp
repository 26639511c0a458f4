// Files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace raywise {

/// Writes `bytes` to `path`. A regular file is written beside its place under a temporary name and
/// then moved there, so a reader sees the old file or the new one, never a part; devices and pipes
/// are written directly. Throws Error (ErrorKind::io, naming `path`) when the file system refuses;
/// no temporary file stays behind.
void write_file(const std::string& path, std::span<const std::byte> bytes);

/// The same for text.
void write_file(const std::string& path, std::string_view text);

} // namespace raywise
