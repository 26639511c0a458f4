// Where data goes: standard output or the file of -o, whole or not at all.
#pragma once

#include <string>
#include <string_view>

namespace raywise::app {

/// Writes the data to standard output, or to `path` unless it is empty. Throws Error
/// (ErrorKind::io) when it does not fit or nobody reads it.
void put(const std::string& path, std::string_view data);

} // namespace raywise::app
