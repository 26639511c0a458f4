// The header of a PLY file: its format and its elements. After [Turk94].
#pragma once

#include "scene_reader.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::io_detail {

enum class PlyFormat : std::uint8_t { ascii, little_endian, big_endian };

enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

[[nodiscard]] constexpr std::size_t size_of(PlyType type) {
    switch (type) {
    case PlyType::i8:
    case PlyType::u8:
        return 1;
    case PlyType::i16:
    case PlyType::u16:
        return 2;
    case PlyType::i32:
    case PlyType::u32:
    case PlyType::f32:
        return 4;
    case PlyType::f64:
        return 8;
    }
    return 0;
}

[[nodiscard]] constexpr bool is_integer(PlyType type) {
    return type != PlyType::f32 && type != PlyType::f64;
}

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::f32; ///< of the value, or of a list's items
    bool is_list = false;
    PlyType count_type = PlyType::u8; ///< of a list's length; an integer type
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties; ///< at least one when count > 0
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::size_t size = 0;         ///< bytes up to the body
    std::uint64_t line_count = 0; ///< lines up to the body
};

/// Throws Error when it is no header, or claims more than the file can hold.
[[nodiscard]] PlyHeader read_ply_header(const SceneReader& reader);

} // namespace raywise::io_detail
