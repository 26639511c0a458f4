// Smallest and largest by value: std::min and std::max return references, which compilers turn into
// branches that triangles mispredict.
#pragma once

#include <hwy/base.h>

namespace raywise::detail {

template <class T>
[[nodiscard]] HWY_INLINE T lesser(T a, T b) {
    return a < b ? a : b;
}

template <class T>
[[nodiscard]] HWY_INLINE T greater(T a, T b) {
    return a > b ? a : b;
}

template <class T>
[[nodiscard]] HWY_INLINE T least_of(T a, T b, T c) {
    return lesser(lesser(a, b), c);
}

template <class T>
[[nodiscard]] HWY_INLINE T greatest_of(T a, T b, T c) {
    return greater(greater(a, b), c);
}

} // namespace raywise::detail
