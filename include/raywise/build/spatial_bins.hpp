// References cut into equal parts of a node's box on all three axes. After [Stich09]; ours: cross
// sections of the triangle at the planes instead of repeated cuts, so each plane costs once.
#pragma once

#include <raywise/build/prim_box.hpp>
#include <raywise/build/quad.hpp>
#include <raywise/build/split.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace raywise {

/// Cuts a box into equal parts on each axis.
class SpatialGrid {
public:
    static constexpr int most = 64; ///< parts per axis

    SpatialGrid(const Aabb& box, int part_count);

    [[nodiscard]] int part_count() const { return part_count_; }

    /// False where the box is too thin for that many different planes.
    [[nodiscard]] bool can_cut(int axis) const { return scale_[axis] > 0; }

    /// The lower end of a part; that of part 0 is the box's own.
    [[nodiscard]] float plane(int axis, int part) const {
        return lo_[axis] + static_cast<float>(part) * step_[axis];
    }

    /// About where a point is, in each lane: in [0, part_count). 0 where it cannot cut.
    [[nodiscard]] IntQuad parts_of(Quad point) const {
        const Quad place = min((point - lo_) * scale_, last_);
        return __builtin_convertvector(max(place, make_quad(0)), IntQuad);
    }

private:
    Quad lo_;
    Quad step_{};
    Quad scale_{};
    Quad last_;
    int part_count_;
};

/// Per part: the box of the pieces in it, and how many references begin and end there.
class SpatialBins {
public:
    explicit SpatialBins(int part_count);

    void
    add(const PrimBox* items,
        std::size_t count,
        const TriangleView& triangles,
        const SpatialGrid& grid);
    void add(const SpatialBins& other);

    [[nodiscard]] const QuadBox& box(int part, int axis) const { return boxes()[at(part, axis)]; }

    /// References that begin in a part.
    [[nodiscard]] std::uint32_t entries(int part, int axis) const {
        return entries_[at(part, axis)];
    }

    /// References that end in a part.
    [[nodiscard]] std::uint32_t exits(int part, int axis) const { return exits_[at(part, axis)]; }

private:
    static constexpr std::size_t most = std::size_t{3} * SpatialGrid::most;

    [[nodiscard]] static std::size_t at(int part, int axis) {
        return static_cast<std::size_t>(part) * 3 + static_cast<std::size_t>(axis);
    }

    template <int Axis>
    void
    cut(const PrimBox& item,
        const std::array<Quad, 3>& corners,
        const SpatialGrid& grid,
        int first,
        int last);

    [[nodiscard]] QuadBox* boxes() { return reinterpret_cast<QuadBox*>(storage_.data()); }

    [[nodiscard]] const QuadBox* boxes() const {
        return reinterpret_cast<const QuadBox*>(storage_.data());
    }

    int part_count_;
    std::array<std::uint32_t, most> entries_; // only as many as the grid has parts are ever touched
    std::array<std::uint32_t, most> exits_;
    alignas(32) std::array<std::byte, most * sizeof(QuadBox)> storage_;
};

/// The bins of a range; the same for any executor.
void fill_bins(
    SpatialBins& bins,
    const PrimRange& range,
    const TriangleView& triangles,
    const SpatialGrid& grid,
    const Executor& executor
);

} // namespace raywise
