// Where parallel work runs: a task arena of the caller's size, never the global scheduler.
#pragma once

#include <raywise/core/function_ref.hpp>

#include <cstddef>
#include <memory>

namespace raywise {

/// Runs tasks on at most `threads()` threads, the caller's included. Cheap to pass by reference;
/// safe to use from several threads; with one thread everything runs in the caller, in order. An
/// exception of a task reaches the caller.
class Executor {
public:
    /// `threads`: 0 for all hardware threads, 1 for serial work; at most 1024, of which no more run
    /// than the machine has. Throws Error when out of range.
    explicit Executor(int threads = 0);
    ~Executor();
    Executor(Executor&&) noexcept;
    Executor& operator=(Executor&&) noexcept;
    Executor(const Executor&) = delete;
    Executor& operator=(const Executor&) = delete;

    [[nodiscard]] int threads() const { return threads_; }

    /// Runs both, in parallel when a thread is free; returns when both are done. May be nested.
    void invoke(FunctionRef<void()> first, FunctionRef<void()> second) const;

    /// Calls `work(begin, end)` for the chunks [0, chunk), [chunk, 2 chunk), ... of [0, count), in
    /// any order and in parallel. The chunks do not depend on the number of threads, so neither
    /// need the results. chunk >= 1.
    void for_each_chunk(
        std::size_t count,
        std::size_t chunk,
        FunctionRef<void(std::size_t begin, std::size_t end)> work
    ) const;

private:
    struct Arena;
    int threads_;
    std::unique_ptr<Arena> arena_; ///< null when serial
};

/// An executor of one thread, for callers that do not care.
[[nodiscard]] const Executor& serial_executor();

} // namespace raywise
