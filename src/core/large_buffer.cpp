#include <raywise/core/large_buffer.hpp>

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace raywise {

namespace {

constexpr std::size_t cache_line = 64;
constexpr std::size_t large_page = std::size_t{2} << 20U;

} // namespace

void* allocate_large(std::size_t bytes) {
    const bool is_large = bytes >= large_page / 2;
    const std::size_t boundary = is_large ? large_page : cache_line;
    if (bytes > static_cast<std::size_t>(-1) - boundary) throw std::bad_alloc();
    // The last large page may be left half empty, but not more.
    const std::size_t unit = bytes % large_page >= large_page / 2 ? boundary : cache_line;
    const std::size_t rounded = (bytes / unit + 1) * unit;
    void* memory = nullptr;
    if (posix_memalign(&memory, boundary, rounded) != 0) throw std::bad_alloc();
    // Advice only: where it is refused, small pages do.
    if (is_large) static_cast<void>(madvise(memory, rounded, MADV_HUGEPAGE));
    return memory;
}

void free_large(void* memory) noexcept {
    std::free(memory);
}

} // namespace raywise
