// Triangles drawn over rays, several rays per operation. After [Aila04], [Johnson05]. Compiled once
// for each instruction set.
#include "pencil/inversion/raster.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/pencil/pencil.hpp>

#include <cstddef>

// The same instructions as a neighbor's, or no gain here: fewer copies of the code.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pencil/inversion/raster.cpp"
// The order matters: foreach_target.h includes this file anew for every target.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "pencil/inversion/aim.inl.hpp"
#include "pencil/inversion/walk.inl.hpp"
#include "pencil/inversion/plane_depth.inl.hpp"
#include "pencil/inversion/draw_run.inl.hpp"
#include "pencil/inversion/drawing.inl.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();

namespace raywise::detail::HWY_NAMESPACE {

template <bool is_radial, bool is_closest>
void draw_range(const Raster& raster, std::size_t first, std::size_t last) {
    Drawing<is_radial, is_closest> drawing(raster);
    for (std::size_t i = first; i < last; ++i)
        drawing.draw(to_prim(i));
    drawing.finish();
}

void draw_triangles(const Raster& raster, std::size_t first, std::size_t last) {
    const bool is_radial = raster.pencil.kind() == Pencil::Kind::radial;
    if (raster.hits != nullptr) {
        is_radial ? draw_range<true, false>(raster, first, last)
                  : draw_range<false, false>(raster, first, last);
    } else {
        is_radial ? draw_range<true, true>(raster, first, last)
                  : draw_range<false, true>(raster, first, last);
    }
}

} // namespace raywise::detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace raywise::detail {

HWY_EXPORT(draw_triangles);

void draw(const Raster& raster, std::size_t first, std::size_t last) {
    HWY_DYNAMIC_DISPATCH(draw_triangles)(raster, first, last);
}

} // namespace raywise::detail

#endif
