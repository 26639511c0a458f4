// Tells the thread sanitizer what the scheduler guarantees: work handed over happens after it was
// handed over, and what a task did happens before its caller goes on. The scheduler's library is
// not instrumented, so its own synchronization is invisible; executor.cpp, which instantiates its
// templates, is left out of the instrumentation for the same reason.
#pragma once

#ifdef RAYWISE_THREAD_SANITIZER
extern "C" {
void __tsan_acquire(void* address); // NOLINT(bugprone-reserved-identifier): the sanitizer's name
void __tsan_release(void* address); // NOLINT(bugprone-reserved-identifier)
}
#endif

namespace raywise {

/// One fork and join. Costs nothing without the sanitizer.
class Handover {
public:
    Handover() { release(&fork_); }
    ~Handover() { acquire(&join_); }
    Handover(const Handover&) = delete;
    Handover& operator=(const Handover&) = delete;

    /// Runs a task between the fork and the join. What it throws is handed over as well.
    template <class Task>
    void run(const Task& task) {
        acquire(&fork_);
        const AtEnd join{&join_};
        task();
    }

private:
    /// Releases the point when its scope ends, however it does.
    struct AtEnd {
        explicit AtEnd(char* at) : point(at) {}
        ~AtEnd() { release(point); }
        AtEnd(const AtEnd&) = delete;
        AtEnd& operator=(const AtEnd&) = delete;

        char* point;
    };

    static void acquire([[maybe_unused]] char* point) {
#ifdef RAYWISE_THREAD_SANITIZER
        __tsan_acquire(point);
#endif
    }

    static void release([[maybe_unused]] char* point) {
#ifdef RAYWISE_THREAD_SANITIZER
        __tsan_release(point);
#endif
    }

    char fork_ = 0;
    char join_ = 0;
};

} // namespace raywise
