// How Embree wants its callers to compute.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace raywise::app {

/// Embree asks its callers to flush denormal numbers while it traces; ours must not.
class FlushedDenormals {
public:
#if defined(__SSE2__)
    FlushedDenormals() {
        constexpr unsigned flush_results = 0x8000;
        constexpr unsigned flush_operands = 0x0040;
        _mm_setcsr(before_ | flush_results | flush_operands);
    }

    ~FlushedDenormals() { _mm_setcsr(before_); }
#else
    FlushedDenormals() = default;
    ~FlushedDenormals() = default;
#endif
    FlushedDenormals(const FlushedDenormals&) = delete;
    FlushedDenormals& operator=(const FlushedDenormals&) = delete;
    FlushedDenormals(FlushedDenormals&&) = delete;
    FlushedDenormals& operator=(FlushedDenormals&&) = delete;

private:
#if defined(__SSE2__)
    unsigned before_ = _mm_getcsr();
#endif
};

} // namespace raywise::app
