// One batch of exact rays, answered without building anything: the rays are gridded and every
// triangle is rasterized over them. After [Aila04], [Johnson05]. Ours: the exact answers.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/pencil/pencil.hpp>

#include <cstddef>
#include <span>

namespace raywise {

/// For each ray of the batch: whether some triangle is hit in [t_min, t_max]; exactly what asking
/// every triangle by ExactKernel answers, so the same for any number of threads. Invalid rays hit
/// nothing. `hits` has the size of `rays`. Throws Error when the sizes differ or a valid ray is not
/// one of the pencil's.
///
/// For a pencil that is used once: a sun of thousands, a lamp that moves. Cost: linear in rays and
/// triangles, and in the pairs of rays and triangles that meet in the picture seen along the
/// pencil; a ray that is decided drops out. Slow where very many rays lie on one line. Memory: at
/// most `inversion_bytes(rays)`, none per triangle; freed on return.
void any_hits_once(
    const TriangleView& triangles,
    const Pencil& pencil,
    std::span<const Ray> rays,
    std::span<bool> hits,
    const Executor& executor = serial_executor()
);

/// The same for the hit with the smallest (t, triangle id) of each ray. A miss is a Hit with
/// prim == no_prim.
void closest_hits_once(
    const TriangleView& triangles,
    const Pencil& pencil,
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor = serial_executor()
);

/// What a one-shot batch takes on one thread, in nanoseconds of one core of a server of 2023: only
/// ratios with other such figures mean something, and those within a factor of two. Fitted to
/// scans, terrain and buildings at half a ray to four rays per triangle.
[[nodiscard]] double
predicted_inversion_ns(Pencil::Kind kind, std::size_t triangles, std::size_t rays);

/// The most memory that a one-shot batch of so many rays takes beside its arguments, in bytes.
[[nodiscard]] std::size_t inversion_bytes(std::size_t rays);

} // namespace raywise
