// Zip archives of a few members, as numpy's .npz are: read stored or deflated, written stored.
// After [Appnote].
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace raywise::io_detail {

/// The members of an archive by name. Throws Error, with the byte, for what is malformed: sizes and
/// offsets beyond the file, overlapping members, wrong checksums, a repeated name, more data than
/// deflate can yield, encryption, ZIP64 directories.
[[nodiscard]] std::map<std::string, std::string, std::less<>>
read_zip(const std::filesystem::path& path, std::string_view bytes);

/// An archive of the members (name, content), stored, in this order; the same bytes every time.
/// Throws Error beyond 4 GiB.
[[nodiscard]] std::string write_zip(std::span<const std::pair<std::string, std::string>> members);

} // namespace raywise::io_detail
