// Uninitialized memory for the big arrays of a build, on large pages where the system offers them.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace raywise {

/// At least `bytes` bytes on a cache line; from 1 MiB on, on the boundaries of large pages that the
/// system is asked for: fewer page faults and address translations. Throws std::bad_alloc. Release
/// with free_large.
[[nodiscard]] void* allocate_large(std::size_t bytes);
void free_large(void* memory) noexcept;

/// An array of `count` elements that nobody has written yet.
template <class T>
    requires std::is_trivially_destructible_v<T>
class LargeBuffer {
public:
    explicit LargeBuffer(std::size_t count)
        : elements_(static_cast<T*>(allocate_large(count * sizeof(T)))) {}

    [[nodiscard]] T* get() const { return elements_.get(); }

    [[nodiscard]] T& operator[](std::size_t i) const { return elements_.get()[i]; }

private:
    struct Free {
        void operator()(T* elements) const { free_large(elements); }
    };

    std::unique_ptr<T, Free> elements_;
};

} // namespace raywise
