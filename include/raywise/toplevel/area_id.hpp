// The index of an influence area, which cannot be mixed up with a triangle's or a node's.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raywise {

/// An influence area, by its place in the list that an index or an accelerator was built from.
enum class AreaId : std::uint32_t {};

[[nodiscard]] constexpr AreaId to_area(std::size_t index) {
    return static_cast<AreaId>(static_cast<std::uint32_t>(index));
}

} // namespace raywise
