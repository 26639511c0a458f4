// Indices that cannot be mixed up.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raywise {

/// A triangle of the scene, by its place in the input.
enum class PrimId : std::uint32_t {};

/// A node of one tree, by its place in the node array.
enum class NodeId : std::uint32_t {};

inline constexpr PrimId no_prim{0xFFFFFFFFU};

template <class Id>
    requires(sizeof(Id) == sizeof(std::uint32_t))
[[nodiscard]] constexpr std::size_t to_index(Id id) {
    return static_cast<std::size_t>(id);
}

[[nodiscard]] constexpr PrimId to_prim(std::size_t index) {
    return static_cast<PrimId>(static_cast<std::uint32_t>(index));
}

[[nodiscard]] constexpr NodeId to_node(std::size_t index) {
    return static_cast<NodeId>(static_cast<std::uint32_t>(index));
}

} // namespace raywise
