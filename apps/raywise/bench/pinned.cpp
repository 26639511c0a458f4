#include "bench/pinned.hpp"

#include <raywise/core/executor.hpp>

#include <memory>
#include <utility>

#if defined(__linux__)
#include <sched.h>
#endif

namespace raywise::app {

#if defined(__linux__)

struct Pinned::Before {
    cpu_set_t processors;
};

Pinned::Pinned(const Executor& executor) {
    if (executor.threads() > 1) return;
    auto before = std::make_unique<Before>();
    if (sched_getaffinity(0, sizeof before->processors, &before->processors) != 0) return;
    const int here = sched_getcpu();
    if (here < 0 || here >= CPU_SETSIZE) return;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<unsigned>(here), &one);
    if (sched_setaffinity(0, sizeof one, &one) == 0) before_ = std::move(before);
}

Pinned::~Pinned() {
    if (before_)
        static_cast<void>(sched_setaffinity(0, sizeof before_->processors, &before_->processors));
}

#else

struct Pinned::Before {};

Pinned::Pinned(const Executor&) {}

Pinned::~Pinned() = default;

#endif

} // namespace raywise::app
