// A vector for the big arrays of a query: large pages, and no pass of zeros before the writing.
#pragma once

#include <raywise/core/large_buffer.hpp>

#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace raywise {

/// Takes memory from allocate_large. `resize` leaves new elements of trivial types unwritten.
template <class T>
struct LargeAllocator {
    static_assert(alignof(T) <= 64, "allocate_large promises a cache line");

    using value_type = T;

    LargeAllocator() = default;

    template <class U>
    // NOLINTNEXTLINE(google-explicit-constructor): what the allocator requirements ask for.
    LargeAllocator(const LargeAllocator<U>&) {}

    [[nodiscard]] T* allocate(std::size_t count) {
        if (count > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_alloc();
        return static_cast<T*>(allocate_large(count * sizeof(T)));
    }

    void deallocate(T* memory, std::size_t) noexcept { free_large(memory); }

    template <class U, class... Args>
    void construct(U* at, Args&&... args) {
        if constexpr (sizeof...(Args) == 0)
            ::new (static_cast<void*>(at)) U;
        else
            std::construct_at(at, std::forward<Args>(args)...);
    }

    friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

template <class T>
using LargeVector = std::vector<T, LargeAllocator<T>>;

} // namespace raywise
