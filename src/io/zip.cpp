#include "byte_reader.hpp"
#include "zip.hpp"

#include <raywise/core/error.hpp>

#include <fmt/format.h>
#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace raywise::io_detail {

namespace {

constexpr std::size_t local_size = 30;
constexpr std::size_t central_size = 46;
constexpr std::size_t end_size = 22;
constexpr std::uint32_t local_mark = 0x04034B50;
constexpr std::uint32_t central_mark = 0x02014B50;
constexpr std::uint32_t end_mark = 0x06054B50;
constexpr std::uint16_t stored = 0;
constexpr std::uint16_t deflated = 8;

std::uint32_t checksum(std::string_view bytes) {
    const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
    return static_cast<std::uint32_t>(::crc32_z(0, data, bytes.size()));
}

/// What the central directory says about a member.
struct Entry {
    std::string name;
    std::uint16_t flags = 0;
    std::uint16_t method = 0;
    std::uint32_t crc = 0;
    std::size_t packed = 0;
    std::size_t size = 0;
    std::size_t local_at = 0;
};

class ZipReader {
public:
    ZipReader(const std::filesystem::path& path, std::string_view bytes)
        : path_(path), bytes_(bytes) {}

    std::map<std::string, std::string, std::less<>> read() {
        find_directory();
        std::map<std::string, std::string, std::less<>> members;
        std::size_t at = directory_at_;
        for (std::size_t i = 0; i < count_; ++i) {
            const Entry entry = read_entry(at);
            if (!members.emplace(entry.name, unpack(entry)).second)
                refuse(at, fmt::format("member '{}' is repeated", escaped(entry.name, 60)));
        }
        if (at != end_at_) refuse(at, "data between the directory and its end");
        return members;
    }

private:
    [[noreturn]] void refuse(std::size_t at, std::string_view reason) const {
        throw Error(path_.string(), at_byte(at), fmt::format("zip: {}", reason));
    }

    template <class T>
    [[nodiscard]] T number(std::size_t at) const {
        return load<T>(bytes_, at);
    }

    void find_directory() {
        if (bytes_.size() < end_size || number<std::uint32_t>(0) != local_mark)
            refuse(0, "not an archive with members");
        end_at_ = bytes_.size() - end_size; // archives of numpy have no comment
        if (number<std::uint32_t>(end_at_) != end_mark || number<std::uint16_t>(end_at_ + 20) != 0)
            refuse(end_at_, "the directory's end is missing");
        count_ = number<std::uint16_t>(end_at_ + 10);
        const std::size_t size = number<std::uint32_t>(end_at_ + 12);
        directory_at_ = number<std::uint32_t>(end_at_ + 16);
        if (number<std::uint32_t>(end_at_ + 4) != 0 || number<std::uint16_t>(end_at_ + 8) != count_)
            refuse(end_at_, "archives of several files are not supported");
        if (directory_at_ > end_at_ || size != end_at_ - directory_at_)
            refuse(end_at_, "the directory is not where its end says");
    }

    Entry read_entry(std::size_t& at) const {
        if (end_at_ - at < central_size || number<std::uint32_t>(at) != central_mark)
            refuse(at, "a directory entry is malformed");
        Entry entry;
        entry.flags = number<std::uint16_t>(at + 8);
        entry.method = number<std::uint16_t>(at + 10);
        entry.crc = number<std::uint32_t>(at + 16);
        entry.packed = number<std::uint32_t>(at + 20);
        entry.size = number<std::uint32_t>(at + 24);
        const std::size_t name_size = number<std::uint16_t>(at + 28);
        const std::size_t more =
            std::size_t{number<std::uint16_t>(at + 30)} + number<std::uint16_t>(at + 32);
        entry.local_at = number<std::uint32_t>(at + 42);
        if (end_at_ - at - central_size < name_size + more)
            refuse(at, "a directory entry ends beyond the directory");
        entry.name = bytes_.substr(at + central_size, name_size);
        if ((entry.flags & 1U) != 0) refuse(at, "encrypted members are not supported");
        at += central_size + name_size + more;
        return entry;
    }

    [[nodiscard]] std::string unpack(const Entry& entry) {
        const std::size_t at = entry.local_at;
        // Members stand one after the other before the directory: none is read twice.
        if (at < last_end_ || at > directory_at_ || directory_at_ - at < local_size ||
            number<std::uint32_t>(at) != local_mark)
            refuse(at, "a member is not where the directory says");
        const std::size_t data_at =
            at + local_size + number<std::uint16_t>(at + 26) + number<std::uint16_t>(at + 28);
        if (data_at > directory_at_ || entry.packed > directory_at_ - data_at)
            refuse(at, "a member ends beyond the directory");
        last_end_ = data_at + entry.packed;
        const std::string_view packed = bytes_.substr(data_at, entry.packed);
        std::string content;
        if (entry.method == stored && entry.packed == entry.size)
            content = packed;
        else if (entry.method == deflated)
            content = inflate(packed, entry.size, data_at);
        else
            refuse(at, fmt::format("method {} is not supported", entry.method));
        if (checksum(content) != entry.crc) refuse(data_at, "a member's checksum is wrong");
        return content;
    }

    [[nodiscard]] std::string
    inflate(std::string_view packed, std::size_t size, std::size_t at) const {
        constexpr std::size_t most_per_byte = 1032; // of deflate
        if (size / most_per_byte > packed.size())
            refuse(at, "a member claims more than deflate can yield");
        std::string content(size, '\0');
        z_stream stream{};
        if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) refuse(at, "cannot be inflated");
        // Both sizes come from 32-bit fields.
        stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data()));
        stream.avail_in = static_cast<uInt>(packed.size());
        stream.next_out = reinterpret_cast<Bytef*>(content.data());
        stream.avail_out = static_cast<uInt>(size);
        const int result = ::inflate(&stream, Z_FINISH);
        const bool is_whole =
            result == Z_STREAM_END && stream.avail_out == 0 && stream.avail_in == 0;
        ::inflateEnd(&stream);
        if (!is_whole) refuse(at, "a member's deflated data is malformed");
        return content;
    }

    const std::filesystem::path& path_;
    std::string_view bytes_;
    std::size_t end_at_ = 0;
    std::size_t directory_at_ = 0;
    std::size_t count_ = 0;
    std::size_t last_end_ = 0; ///< of the members read so far
};

} // namespace

std::map<std::string, std::string, std::less<>>
read_zip(const std::filesystem::path& path, std::string_view bytes) {
    return ZipReader(path, bytes).read();
}

std::string write_zip(std::span<const std::pair<std::string, std::string>> members) {
    std::string bytes;
    std::string directory;
    for (const auto& [name, content] : members) {
        if (bytes.size() + content.size() > std::numeric_limits<std::uint32_t>::max() - 65'536)
            throw Error("an archive cannot exceed 4 GiB");
        const auto at = static_cast<std::uint32_t>(bytes.size());
        std::string common; // version, flags, method, time, date, checksum, sizes, name, extra
        append(common, std::uint16_t{20});
        append(common, std::uint16_t{0});
        append(common, stored);
        append(common, std::uint16_t{0});
        append(common, std::uint16_t{0x21}); // January 1, 1980
        append(common, checksum(content));
        append(common, static_cast<std::uint32_t>(content.size()));
        append(common, static_cast<std::uint32_t>(content.size()));
        append(common, static_cast<std::uint16_t>(name.size()));
        append(common, std::uint16_t{0});
        append(bytes, local_mark);
        bytes.append(common).append(name).append(content);
        append(directory, central_mark);
        append(directory, std::uint16_t{20});
        directory += common;
        directory += std::string(2 + 2 + 2 + 4, '\0'); // comment, disk, attributes
        append(directory, at);
        directory += name;
    }
    const auto at = static_cast<std::uint32_t>(bytes.size());
    bytes += directory;
    append(bytes, end_mark);
    append(bytes, std::uint32_t{0});
    append(bytes, static_cast<std::uint16_t>(members.size()));
    append(bytes, static_cast<std::uint16_t>(members.size()));
    append(bytes, static_cast<std::uint32_t>(directory.size()));
    append(bytes, at);
    append(bytes, std::uint16_t{0});
    return bytes;
}

} // namespace raywise::io_detail
