#include <raywise/io/occlusion_file.hpp>

#include <raywise/io/files.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace raywise {

namespace {

/// Format version 1.0: magic, version, header length, a Python dictionary padded so that data
/// starts at 64 bytes.
std::string npy_header(std::size_t count) {
    std::string dictionary =
        "{'descr': '|b1', 'fortran_order': False, 'shape': (" + std::to_string(count) + ",), }";
    constexpr std::size_t prefix = 10, alignment = 64;
    while ((prefix + dictionary.size() + 1) % alignment != 0)
        dictionary += ' ';
    dictionary += '\n';
    std::string header("\x93NUMPY\x01\x00", 8);
    header += static_cast<char>(dictionary.size() & 0xFFU);
    header += static_cast<char>(dictionary.size() >> 8U);
    return header + dictionary;
}

} // namespace

void save_occlusion(const std::string& path, std::span<const std::uint8_t> occluded) {
    std::string bytes = npy_header(occluded.size());
    bytes.reserve(bytes.size() + occluded.size());
    for (const std::uint8_t flag : occluded)
        bytes += static_cast<char>(flag != 0 ? 1 : 0);
    write_file_atomically(path, bytes);
}

} // namespace raywise
