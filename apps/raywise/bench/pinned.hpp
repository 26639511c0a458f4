// Keeps the calling thread on one processor while something is timed.
#pragma once

#include <raywise/core/executor.hpp>

#include <memory>

namespace raywise::app {

/// As long as it lives, the calling thread stays on the processor it runs on: both sides of a pair
/// find the same caches. Does nothing when the executor uses several threads (the system places
/// them alike for both sides) or where the system does not offer it.
class Pinned {
public:
    explicit Pinned(const Executor& executor);
    ~Pinned();
    Pinned(const Pinned&) = delete;
    Pinned& operator=(const Pinned&) = delete;
    Pinned(Pinned&&) = delete;
    Pinned& operator=(Pinned&&) = delete;

private:
    struct Before;
    std::unique_ptr<Before> before_;
};

} // namespace raywise::app
