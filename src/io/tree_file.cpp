// Layout of a .rwtree file, little-endian: a header of 64 bytes, a table of two sections of 32
// bytes each, then the sections without gaps. The header's checksum covers header and table, the
// table's checksums cover the sections: no byte is without one.
#include <raywise/io/tree_file.hpp>

#include "byte_reader.hpp"

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/hash.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/io/files.hpp>

#include <fmt/format.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace raywise {

namespace {

using io_detail::append;
using io_detail::load;

static_assert(std::endian::native == std::endian::little, "nodes are written as they stand");
static_assert(std::is_trivially_copyable_v<Node>);

constexpr std::string_view magic = "\x89RWT\r\n\x1A\n"; // changed by any text-mode transfer
constexpr std::uint32_t version = 1;
constexpr std::uint32_t byte_order = 0x01020304;
constexpr std::size_t header_size = 64;
constexpr std::size_t section_size = 32;
constexpr std::size_t checksum_at = 56;
constexpr std::size_t data_at = header_size + 2 * section_size;

/// The sections in their order.
enum class Section : std::uint32_t { nodes = 1, prims = 2 };

std::uint64_t hash_text(std::string_view bytes) {
    return hash_bytes(std::as_bytes(std::span(bytes)));
}

/// Of the header and the table, without the checksum itself.
std::uint64_t header_checksum(std::string_view bytes) {
    std::string covered(bytes.substr(0, checksum_at));
    covered += bytes.substr(header_size, 2 * section_size);
    return hash_text(covered);
}

template <class T>
std::string_view bytes_of(const std::vector<T>& items) {
    return {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T)};
}

void append_section(
    std::string& table,
    Section section,
    std::size_t item_size,
    std::size_t at,
    std::string_view bytes
) {
    append(table, static_cast<std::uint32_t>(section));
    append(table, static_cast<std::uint32_t>(item_size));
    append(table, std::uint64_t{at});
    append(table, std::uint64_t{bytes.size()});
    append(table, hash_text(bytes));
}

/// One reading of a file's bytes; every refusal names the byte.
class TreeReader {
public:
    TreeReader(const std::filesystem::path& path, std::string_view bytes)
        : path_(path), bytes_(bytes) {}

    TreeFile read() {
        check_header();
        TreeFile content;
        content.scene_hash = load<std::uint64_t>(bytes_, 32);
        content.prim_count = load<std::uint64_t>(bytes_, 40);
        content.tree.nodes = read_section<Node>(0, Section::nodes);
        content.tree.prims = read_section<PrimId>(1, Section::prims);
        if (end_ != bytes_.size()) refuse(end_, "data beyond the last section");
        if (const auto fault = find_fault(content.tree, content.prim_count))
            refuse(data_at, *fault);
        return content;
    }

private:
    [[noreturn]] void refuse(std::size_t at, std::string_view reason) const {
        throw Error(path_.string(), at_byte(at), reason);
    }

    void check_header() const {
        if (bytes_.size() < magic.size() || bytes_.substr(0, magic.size()) != magic)
            refuse(0, "not a tree file");
        if (bytes_.size() < data_at) refuse(bytes_.size(), "the header ends too early");
        // Version and byte order come first: with others the rest may mean anything.
        if (const auto found = load<std::uint32_t>(bytes_, 8); found != version)
            refuse(8, fmt::format("version {} is not supported; {} is", found, version));
        if (load<std::uint32_t>(bytes_, 12) != byte_order)
            refuse(12, "the byte order is not supported");
        if (load<std::uint64_t>(bytes_, checksum_at) != header_checksum(bytes_))
            refuse(checksum_at, "the header's checksum is wrong");
        if (load<std::uint64_t>(bytes_, 16) != bytes_.size())
            refuse(16, fmt::format("the file has {} bytes, not those it says", bytes_.size()));
        if (load<std::uint64_t>(bytes_, 24) != 2) refuse(24, "it must have two sections");
        if (load<std::uint64_t>(bytes_, 48) != 0) refuse(48, "reserved bytes are set");
    }

    template <class T>
    std::vector<T> read_section(std::size_t which, Section section) {
        const std::size_t entry = header_size + which * section_size;
        if (load<std::uint32_t>(bytes_, entry) != static_cast<std::uint32_t>(section) ||
            load<std::uint32_t>(bytes_, entry + 4) != sizeof(T))
            refuse(entry, "not the section that belongs here");
        const auto at = load<std::uint64_t>(bytes_, entry + 8);
        const auto size = load<std::uint64_t>(bytes_, entry + 16);
        if (at != end_ || size > bytes_.size() - at || size % sizeof(T) != 0)
            refuse(entry, "the section is not within the file");
        const std::string_view content = bytes_.substr(at, size);
        if (load<std::uint64_t>(bytes_, entry + 24) != hash_text(content))
            refuse(at, "the section's checksum is wrong");
        end_ = at + size;
        std::vector<T> items(size / sizeof(T));
        if (size != 0) std::memcpy(static_cast<void*>(items.data()), content.data(), size);
        return items;
    }

    const std::filesystem::path& path_;
    std::string_view bytes_;
    std::size_t end_ = data_at; ///< of the sections read so far
};

} // namespace

void save_tree(const std::filesystem::path& path, const TreeFile& content) {
    validate(content.tree, content.prim_count);
    const std::string_view nodes = bytes_of(content.tree.nodes);
    const std::string_view prims = bytes_of(content.tree.prims);
    std::string bytes(magic);
    append(bytes, version);
    append(bytes, byte_order);
    append(bytes, std::uint64_t{data_at + nodes.size() + prims.size()});
    append(bytes, std::uint64_t{2}); // sections
    append(bytes, content.scene_hash);
    append(bytes, std::uint64_t{content.prim_count});
    append(bytes, std::uint64_t{0}); // reserved
    append(bytes, std::uint64_t{0}); // the checksum's place
    append_section(bytes, Section::nodes, sizeof(Node), data_at, nodes);
    append_section(bytes, Section::prims, sizeof(PrimId), data_at + nodes.size(), prims);
    std::string checksum;
    append(checksum, header_checksum(bytes));
    bytes.replace(checksum_at, checksum.size(), checksum);
    bytes += nodes;
    bytes += prims;
    write_file_atomically(path, bytes);
}

TreeFile load_tree(const std::filesystem::path& path) {
    const std::string bytes = read_file(path);
    return TreeReader(path, bytes).read();
}

} // namespace raywise
