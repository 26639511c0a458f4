#include <raywise/build/prim_box.hpp>

#include <raywise/build/quad.hpp>
#include <raywise/build/split.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/large_buffer.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/vec.hpp>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

namespace raywise {

namespace {

constexpr float largest = 0x1p60F;

bool is_buildable(const Aabb& box) {
    const auto in_range = [](Vec3 v) {
        return std::abs(v.x) <= largest && std::abs(v.y) <= largest && std::abs(v.z) <= largest;
    };
    return in_range(box.lo) && in_range(box.hi) && !box.is_empty();
}

PrimBox prim_box(const Aabb& box, std::size_t id) {
    const auto low = static_cast<float>(id & 0xFFFFU);
    const auto high = static_cast<float>(id >> 16U);
    // Adding +0 turns -0 into +0 and leaves the rest alone.
    const Quad zero = make_quad(0);
    return {
        Quad{box.lo.x, box.lo.y, box.lo.z, low} + zero,
        Quad{box.hi.x, box.hi.y, box.hi.z, high} + zero
    };
}

void check_count(std::size_t count) {
    constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
    if (count > most) throw Error(ErrorKind::limit, {}, nowhere(), "more than 2^31 - 1 boxes");
}

} // namespace

void check_boxes(std::span<const Aabb> boxes) {
    check_count(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (!is_buildable(boxes[i]))
            throw Error("box " + std::to_string(i) + " is empty, not finite or beyond +-2^60");
}

PrimBoxes load_boxes(std::span<const Aabb> boxes, const Executor& executor, std::size_t room) {
    check_count(boxes.size());
    const std::size_t size = boxes.size() + room;
    PrimBoxes result{LargeBuffer<PrimBox>(size), LargeBuffer<PrimBox>(size)};
    std::atomic<bool> is_bad = false;
    executor.for_each_chunk(boxes.size(), prim_chunk, [&](std::size_t begin, std::size_t end) {
        bool good = true;
        for (std::size_t i = begin; i < end; ++i) {
            good = good && is_buildable(boxes[i]);
            result.items[i] = prim_box(boxes[i], i);
        }
        if (!good) is_bad = true;
    });
    // Looked for again, in order: which chunk finds its offender first depends on the threads.
    if (is_bad) check_boxes(boxes);
    return result;
}

} // namespace raywise
