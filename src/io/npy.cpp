#include "byte_reader.hpp"
#include "npy.hpp"
#include "text_number.hpp"

#include <raywise/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::io_detail {

namespace {

constexpr std::string_view magic = "\x93NUMPY";
constexpr std::uint64_t max_rows = 0xFFFFFFFF;

/// The header's Python dictionary of three known keys, token by token.
class HeaderParser {
public:
    HeaderParser(const std::filesystem::path& path, std::string_view text, std::size_t offset)
        : path_(path), text_(text), offset_(offset) {}

    void parse() {
        expect("{");
        while (!accept("}")) {
            const std::string_view key = quoted();
            expect(":");
            if (key == "descr" && type.empty())
                type = quoted();
            else if (key == "fortran_order" && !has_order_)
                parse_order();
            else if (key == "shape" && !has_shape_)
                parse_shape();
            else
                refuse("an unknown or repeated key");
            if (!accept(",")) {
                expect("}");
                break;
            }
        }
        skip_space();
        if (at_ != text_.size()) refuse("text beyond the dictionary");
        if (type.empty() || !has_order_ || !has_shape_) refuse("a key is missing");
    }

    [[noreturn]] void refuse(std::string_view reason) const {
        throw Error(path_.string(), at_byte(offset_ + at_), fmt::format("npy header: {}", reason));
    }

    std::string_view type;
    bool is_fortran = false;
    std::vector<std::uint64_t> shape;

private:
    void skip_space() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n'))
            ++at_;
    }

    bool accept(std::string_view token) {
        skip_space();
        if (!text_.substr(at_).starts_with(token)) return false;
        at_ += token.size();
        return true;
    }

    void expect(std::string_view token) {
        if (!accept(token)) refuse(fmt::format("'{}' is missing", token));
    }

    std::string_view quoted() {
        skip_space();
        const char mark = at_ < text_.size() ? text_[at_] : '\0';
        if (mark != '\'' && mark != '"') refuse("a quoted word is missing");
        const std::size_t end = text_.find(mark, at_ + 1);
        if (end == std::string_view::npos) refuse("a quote has no end");
        const std::string_view word = text_.substr(at_ + 1, end - at_ - 1);
        at_ = end + 1;
        return word;
    }

    void parse_order() {
        is_fortran = accept("True");
        if (!is_fortran) expect("False");
        has_order_ = true;
    }

    void parse_shape() {
        expect("(");
        while (!accept(")")) {
            skip_space();
            const std::size_t end =
                std::min(text_.find_first_not_of("0123456789", at_), text_.size());
            const auto size = parse_integer(text_.substr(at_, end - at_));
            if (!size || static_cast<std::uint64_t>(*size) > max_rows || shape.size() == 2)
                refuse("a shape that is not supported");
            shape.push_back(static_cast<std::uint64_t>(*size));
            at_ = end;
            if (!accept(",")) {
                expect(")");
                break;
            }
        }
        has_shape_ = true;
    }

    const std::filesystem::path& path_;
    std::string_view text_;
    std::size_t offset_;
    std::size_t at_ = 0;
    bool has_order_ = false;
    bool has_shape_ = false;
};

} // namespace

NpyArray::NpyArray(const std::filesystem::path& path, std::string_view bytes, std::size_t offset) {
    const auto refuse = [&](std::size_t at, std::string_view reason) {
        throw Error(path.string(), at_byte(offset + at), reason);
    };
    if (!bytes.starts_with(magic)) refuse(0, "not a .npy array");
    if (bytes.size() < 12) refuse(bytes.size(), "the array's header ends too early");
    const auto version = load<std::uint8_t>(bytes, 6);
    if (version < 1 || version > 3 || bytes[7] != 0) refuse(6, "the .npy version is not supported");
    const std::size_t text_at = version == 1 ? 10 : 12;
    const std::size_t text_size =
        version == 1 ? load<std::uint16_t>(bytes, 8) : load<std::uint32_t>(bytes, 8);
    if (text_size > bytes.size() - text_at) refuse(8, "the array's header ends beyond the file");
    HeaderParser header(path, bytes.substr(text_at, text_size), offset + text_at);
    header.parse();

    const std::string_view type = header.type;
    if (type == "|b1") {
        kind_ = 'b';
        item_size_ = 1;
    } else if (type == "<f4" || type == ">f4" || type == "<f8" || type == ">f8" || type == "<u4" ||
               type == ">u4") {
        is_big_ = type[0] == '>';
        kind_ = type[1];
        item_size_ = type[2] == '4' ? 4 : 8;
    } else {
        header.refuse(fmt::format("type '{}' is not supported", escaped(type, 40)));
    }
    if (header.shape.empty()) header.refuse("a single number is not an array");
    is_fortran_ = header.is_fortran;
    is_flat_ = header.shape.size() == 1;
    rows_ = header.shape[0];
    if (!is_flat_) columns_ = header.shape[1];
    data_ = bytes.substr(text_at + text_size);
    // Both below 2^32: the first product cannot wrap, and the second is compared by division.
    if (columns_ != 0 && rows_ * columns_ > data_.size() / item_size_)
        refuse(
            bytes.size(),
            fmt::format("{} x {} numbers are more than the file holds", rows_, columns_)
        );
    if (rows_ * columns_ * item_size_ != data_.size())
        refuse(bytes.size(), "the array has more data than its shape");
}

double NpyArray::number(std::size_t row, std::size_t column) const {
    const std::size_t item = is_fortran_ ? column * rows_ + row : row * columns_ + column;
    const std::size_t at = item * item_size_;
    const std::endian order = is_big_ ? std::endian::big : std::endian::little;
    if (kind_ == 'b') return data_[at] != 0 ? 1 : 0;
    if (kind_ == 'u') return load<std::uint32_t>(data_, at, order);
    if (item_size_ == 4) return static_cast<double>(load<float>(data_, at, order));
    return load<double>(data_, at, order);
}

std::string npy_header(std::string_view type, std::string_view shape) {
    std::string text =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
    constexpr std::size_t before = 10;
    constexpr std::size_t alignment = 64;
    text.resize((before + text.size() + 1 + alignment - 1) / alignment * alignment - before, ' ');
    text.back() = '\n';
    std::string bytes(magic);
    bytes += std::string_view("\x01\x00", 2);
    append(bytes, static_cast<std::uint16_t>(text.size()));
    return bytes + text;
}

} // namespace raywise::io_detail
