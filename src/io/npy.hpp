// The .npy format: one array of numbers after a short header. After [Npy].
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::io_detail {

/// An array inside the bytes of a file.
class NpyArray {
public:
    /// Throws Error (naming `path`, and bytes counted from `offset`) unless the bytes are one whole
    /// .npy array of one or two dimensions, of float32, float64, uint32 or bool.
    NpyArray(const std::filesystem::path& path, std::string_view bytes, std::size_t offset);

    [[nodiscard]] std::size_t rows() const { return rows_; }

    /// 1 for an array of one dimension.
    [[nodiscard]] std::size_t columns() const { return columns_; }

    [[nodiscard]] bool is_flat() const { return is_flat_; }

    /// 'f', 'u' or 'b', as numpy names kinds.
    [[nodiscard]] char kind() const { return kind_; }

    /// row < rows(), column < columns().
    [[nodiscard]] double number(std::size_t row, std::size_t column) const;

private:
    std::string_view data_;
    char kind_ = 'f';
    std::size_t item_size_ = 4;
    bool is_big_ = false;
    bool is_fortran_ = false;
    bool is_flat_ = false;
    std::size_t rows_ = 0;
    std::size_t columns_ = 1;
};

/// The header of an array of this type, such as "<f4", and shape, such as "(5, 8)"; its data
/// follows. The size is a multiple of 64.
[[nodiscard]] std::string npy_header(std::string_view type, std::string_view shape);

} // namespace raywise::io_detail
