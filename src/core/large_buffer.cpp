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
    const std::size_t boundary = bytes >= 2 * large_page ? large_page : cache_line;
    if (bytes > static_cast<std::size_t>(-1) - boundary) throw std::bad_alloc();
    const std::size_t rounded = (bytes / boundary + 1) * boundary;
    void* memory = std::aligned_alloc(boundary, rounded);
    if (memory == nullptr) throw std::bad_alloc();
    // Advice only: where it is refused, small pages do.
    if (boundary == large_page) static_cast<void>(madvise(memory, rounded, MADV_HUGEPAGE));
    return memory;
}

void free_large(void* memory) noexcept {
    std::free(memory);
}

} // namespace raywise
