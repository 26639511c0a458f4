#include <raywise/core/executor.hpp>

#include "core/handover.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/function_ref.hpp>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <thread>

namespace raywise {

namespace {

int checked_threads(int threads) {
    constexpr int most = 1024;
    if (threads < 0 || threads > most) throw Error("threads must be in [0, 1024]");
    if (threads > 0) return threads;
    return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

} // namespace

struct Executor::Arena {
    // More threads than the machine has would only make the scheduler complain.
    explicit Arena(int threads) : tasks(std::min(threads, checked_threads(0))) {}

    tbb::task_arena tasks;
};

Executor::Executor(int threads) : threads_(checked_threads(threads)) {
    if (threads_ > 1) arena_ = std::make_unique<Arena>(threads_);
}

Executor::~Executor() = default;
Executor::Executor(Executor&&) noexcept = default;
Executor& Executor::operator=(Executor&&) noexcept = default;

void Executor::invoke(FunctionRef<void()> first, FunctionRef<void()> second) const {
    if (!arena_) {
        first();
        second();
        return;
    }
    Handover handover;
    arena_->tasks.execute([&] {
        tbb::parallel_invoke([&] { handover.run(first); }, [&] { handover.run(second); });
    });
}

void Executor::for_each_chunk(
    std::size_t count,
    std::size_t chunk,
    FunctionRef<void(std::size_t begin, std::size_t end)> work
) const {
    const std::size_t chunks = (count + chunk - 1) / chunk;
    const auto run = [&](std::size_t i) { work(i * chunk, std::min(count, (i + 1) * chunk)); };
    if (!arena_ || chunks < 2) {
        for (std::size_t i = 0; i < chunks; ++i)
            run(i);
        return;
    }
    Handover handover;
    arena_->tasks.execute([&] {
        tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t i) {
            handover.run([&] { run(i); });
        });
    });
}

const Executor& serial_executor() {
    static const Executor serial(1);
    return serial;
}

} // namespace raywise
