// Random triangles of the thesis, with the conversion to real numbers written out: the standard
// leaves it to the library.
#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>

namespace raywise {

namespace {

/// lo + (hi - lo) * (low word + 2^32 high word) / 2^64 in double, then float; a quotient that
/// rounds to 1 becomes the number below it. With these numbers the published build work of the
/// thesis comes out to the last digit (build's guided_test).
float draw(std::mt19937& words, double lo, double hi) {
    const auto low = static_cast<double>(words());
    const auto high = static_cast<double>(words());
    double unit = (low + high * 0x1p32) * 0x1p-64;
    if (unit >= 1) unit = std::nextafter(1.0, 0.0);
    return static_cast<float>(unit * (hi - lo) + lo);
}

Vec3 draw_point(std::mt19937& words, double lo, double hi) {
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis)
        point[axis] = draw(words, lo, hi);
    return point;
}

} // namespace

Scene generate_random_triangles(std::size_t count, std::uint32_t seed, std::size_t skipped) {
    if (count > max_triangles / 3)
        throw Error("random triangles to generate: must be at most 715827882");
    std::mt19937 words(seed); // NOLINT(cert-msc51-cpp): the seed is an argument
    words.discard(18ULL * skipped);
    Scene scene;
    scene.name = "random" + std::to_string(count);
    scene.vertices.reserve(3 * count);
    scene.triangles.reserve(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3 v0 = draw_point(words, 0, 10);
        const Vec3 v1 = v0 + draw_point(words, -1, 1);
        const Vec3 v2 = v1 + draw_point(words, -1, 1);
        scene.vertices.insert(scene.vertices.end(), {v0, v1, v2});
        scene.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return scene;
}

} // namespace raywise
