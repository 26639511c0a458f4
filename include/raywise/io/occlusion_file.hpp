// Answers of any-hit queries in a file that numpy reads.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace raywise {

/// Writes one truth value per ray as .npy: shape (N), bool; nonzero means that something is hit. In
/// one step. Throws Error when the file cannot be written.
void save_occlusion(const std::string& path, std::span<const std::uint8_t> occluded);

} // namespace raywise
