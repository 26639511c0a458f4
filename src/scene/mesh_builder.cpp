#include "scene/mesh_builder.hpp"

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace raywise::scene_detail {

namespace {

/// Taylor series of sine on [0, pi / 4]; the first dropped term is below 1e-17.
double sine_of_octant(double x) {
    double sum = 1;
    for (int n = 17; n >= 3; n -= 2)
        sum = 1 - x * x / (n * (n - 1)) * sum;
    return x * sum;
}

double cosine_of_octant(double x) {
    double sum = 1;
    for (int n = 18; n >= 2; n -= 2)
        sum = 1 - x * x / (n * (n - 1)) * sum;
    return sum;
}

} // namespace

double sine_of_turns(double turns) {
    turns -= std::floor(turns);
    // Reduced to an octant, where the series is short and 0, 1/4, 1/2, 3/4 turns are exact.
    const double eighths = turns * 8;
    const int octant = static_cast<int>(eighths) & 7;
    constexpr double to_rad = std::numbers::pi / 4;
    const double rest = eighths - octant;
    const double sign = octant >= 4 ? -1.0 : 1.0;
    switch (octant & 3) {
    case 0:
        return sign * sine_of_octant(rest * to_rad);
    case 1:
        return sign * cosine_of_octant((1 - rest) * to_rad);
    case 2:
        return sign * cosine_of_octant(rest * to_rad);
    default:
        return sign * sine_of_octant((1 - rest) * to_rad);
    }
}

double cosine_of_turns(double turns) {
    return sine_of_turns(turns + 0.25);
}

void MeshBuilder::begin_group(std::string name) {
    end_group();
    if (scene_ == nullptr) return;
    scene_->groups.push_back(
        {std::move(name), static_cast<std::uint32_t>(scene_->triangles.size()), 0}
    );
}

void MeshBuilder::end_group() {
    if (scene_ == nullptr || scene_->groups.empty() || scene_->groups.back().count != 0) return;
    Group& open = scene_->groups.back();
    open.count = static_cast<std::uint32_t>(scene_->triangles.size()) - open.first;
    if (open.count == 0) scene_->groups.pop_back();
}

std::uint32_t MeshBuilder::add_vertex(Vec3d position) {
    if (scene_ == nullptr) return 0;
    scene_->vertices.push_back(to_float(position));
    return static_cast<std::uint32_t>(scene_->vertices.size() - 1);
}

void MeshBuilder::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    ++triangles_;
    if (scene_ != nullptr) scene_->triangles.push_back({a, b, c});
}

void MeshBuilder::add_quad(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
    const std::uint32_t first = add_vertex(a);
    add_vertex(b);
    add_vertex(c);
    add_vertex(d);
    add_triangle(first, first + 1, first + 2);
    add_triangle(first, first + 2, first + 3);
}

void MeshBuilder::add_patch(
    int columns,
    int rows,
    const std::function<Vec3d(double u, double v)>& point
) {
    if (scene_ == nullptr) {
        triangles_ += 2 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
        return;
    }
    const auto first = static_cast<std::uint32_t>(scene_->vertices.size());
    for (int row = 0; row <= rows; ++row)
        for (int column = 0; column <= columns; ++column)
            add_vertex(point(static_cast<double>(column) / columns, static_cast<double>(row) / rows)
            );
    const auto stride = static_cast<std::uint32_t>(columns) + 1;
    for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row)
        for (std::uint32_t column = 0; column + 1 < stride; ++column) {
            const std::uint32_t a = first + row * stride + column;
            add_triangle(a, a + 1, a + stride + 1);
            add_triangle(a, a + stride + 1, a + stride);
        }
}

void MeshBuilder::add_box(Vec3d lo, Vec3d hi) {
    if (scene_ == nullptr) {
        triangles_ += 12;
        return;
    }
    const auto first = static_cast<std::uint32_t>(scene_->vertices.size());
    for (int i = 0; i < 8; ++i)
        add_vertex(
            {(i & 4) != 0 ? hi.x : lo.x, (i & 2) != 0 ? hi.y : lo.y, (i & 1) != 0 ? hi.z : lo.z}
        );
    const auto face = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        add_triangle(first + a, first + b, first + c);
        add_triangle(first + a, first + c, first + d);
    };
    face(0, 1, 3, 2); // -x
    face(4, 6, 7, 5); // +x
    face(0, 4, 5, 1); // -y
    face(2, 3, 7, 6); // +y
    face(0, 2, 6, 4); // -z
    face(1, 5, 7, 3); // +z
}

void MeshBuilder::add_lathe(Vec3d foot, std::span<const ProfilePoint> profile, int segments) {
    // One ring of vertices per profile point; a point on the axis needs one vertex only.
    if (scene_ == nullptr) {
        for (std::size_t i = 0; i + 1 < profile.size(); ++i)
            triangles_ +=
                static_cast<std::size_t>(segments) *
                ((profile[i].radius != 0 ? 1U : 0U) + (profile[i + 1].radius != 0 ? 1U : 0U));
        return;
    }
    std::vector<std::uint32_t> rings;
    for (const ProfilePoint& point : profile) {
        rings.push_back(static_cast<std::uint32_t>(scene_->vertices.size()));
        const int count = point.radius == 0 ? 1 : segments;
        for (int i = 0; i < count; ++i) {
            const double turn = static_cast<double>(i) / segments;
            add_vertex(
                foot +
                Vec3d{
                    point.radius * cosine_of_turns(turn),
                    point.height,
                    -point.radius * sine_of_turns(turn)
                }
            );
        }
    }
    const auto count = static_cast<std::uint32_t>(segments);
    for (std::size_t i = 0; i + 1 < profile.size(); ++i)
        for (std::uint32_t k = 0; k < count; ++k) {
            const std::uint32_t next = (k + 1) % count;
            const bool below = profile[i].radius != 0;
            const bool above = profile[i + 1].radius != 0;
            const std::uint32_t a = rings[i] + (below ? k : 0);
            const std::uint32_t b = rings[i] + (below ? next : 0);
            const std::uint32_t c = rings[i + 1] + (above ? next : 0);
            const std::uint32_t d = rings[i + 1] + (above ? k : 0);
            if (below) add_triangle(a, b, c);
            if (above) add_triangle(a, c, d);
        }
}

void MeshBuilder::add_sphere(Vec3d center, double radius, int rings) {
    std::vector<ProfilePoint> profile;
    for (int i = 0; i <= rings; ++i) {
        const double turn = 0.5 * i / rings;
        const bool pole = i == 0 || i == rings;
        profile.push_back({pole ? 0 : radius * sine_of_turns(turn), -radius * cosine_of_turns(turn)}
        );
    }
    add_lathe(center, profile, 2 * rings);
}

double fit_detail(std::size_t triangles, const std::function<void(MeshBuilder&, double)>& build) {
    if (triangles < 100 || triangles > 100'000'000)
        throw Error("triangles to generate: must be in [100, 100000000]");
    const auto count = [&](double detail) {
        MeshBuilder counter;
        build(counter, detail);
        return counter.triangles();
    };
    // Counts are monotone in the detail but for rounding: bisection on its logarithm.
    double lo = 0x1p-12;
    double hi = 1;
    while (count(hi) < triangles && hi < 0x1p20)
        hi *= 2;
    for (int i = 0; i < 24; ++i) {
        const double middle = std::sqrt(lo * hi);
        (count(middle) < triangles ? lo : hi) = middle;
    }
    return hi;
}

int scaled(double base, double detail, int least) {
    return std::max(least, static_cast<int>(std::lround(base * detail)));
}

} // namespace raywise::scene_detail
