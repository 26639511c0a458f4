#include "pencil/face_pieces.hpp"
#include "pencil/piece.hpp"
#include "pencil/records.hpp"

#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace raywise::pencil_detail {

namespace {

constexpr std::size_t chunk = 1 << 13;

/// How near to the apex, as a share of the reach, triangles are listed apart: nearer ones could be
/// met by rays that stray too far from their places.
constexpr double near_share = 0x1p-17;

/// Rays of a cube face may stray beyond its edges.
constexpr double edge = 1 + 0x1p-4;

/// Calls `add(index, pieces)` for every one of the records' ids, in parallel; returns all pieces in
/// order.
template <class Add>
std::vector<RawPiece> collect(const Records& records, const Executor& executor, const Add& add) {
    const std::size_t count = records.ids().size();
    std::vector<std::vector<RawPiece>> parts((count + chunk - 1) / chunk);
    executor.for_each_chunk(count, chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<RawPiece>& part = parts[begin / chunk];
        for (std::size_t i = begin; i < end; ++i)
            add(i, part);
    });
    std::vector<std::size_t> starts(parts.size() + 1);
    for (std::size_t i = 0; i < parts.size(); ++i)
        starts[i + 1] = starts[i] + parts[i].size();
    std::vector<RawPiece> pieces(starts.back());
    executor.for_each_chunk(parts.size(), 1, [&](std::size_t i, std::size_t) {
        std::copy(
            parts[i].begin(),
            parts[i].end(),
            pieces.begin() + static_cast<std::ptrdiff_t>(starts[i])
        );
    });
    return pieces;
}

/// A triangle cut by five planes has at most eight corners.
struct Polygon {
    std::array<Vec3d, 9> corners;
    std::size_t count = 0;

    void add(Vec3d corner) { corners[count++] = corner; }
};

/// The part with dot(normal, corner) >= limit. [Sutherland74]
void cut(Polygon& polygon, Vec3d normal, double limit) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const Vec3d a = polygon.corners[i];
        const Vec3d b = polygon.corners[i + 1 == polygon.count ? 0 : i + 1];
        const double inside_a = dot(normal, a) - limit;
        const double inside_b = dot(normal, b) - limit;
        if (inside_a >= 0) kept.add(a);
        if ((inside_a > 0 && inside_b < 0) || (inside_a < 0 && inside_b > 0))
            kept.add(a + (b - a) * (inside_a / (inside_a - inside_b)));
    }
    polygon = kept;
}

/// The cube face that alone sees the triangle, farther than `least`, beyond its edges too; or
/// `several`.
std::uint8_t only_face(const std::array<Vec3d, 3>& seen, double least) {
    const int axis = dominant_axis(seen[0]);
    const bool is_negative = seen[0][axis] < 0;
    const bool is_alone = std::all_of(seen.begin(), seen.end(), [&](const Vec3d& p) {
        const double z = is_negative ? -p[axis] : p[axis];
        return z > least && std::abs(p[(axis + 1) % 3]) * edge < z &&
               std::abs(p[(axis + 2) % 3]) * edge < z;
    });
    return is_alone ? static_cast<std::uint8_t>(2 * axis + (is_negative ? 1 : 0))
                    : Surroundings::several;
}

/// Whether the triangle's box meets the cube around the apex.
bool meets_cube(const std::array<Vec3d, 3>& seen, double half) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax({seen[0][axis], seen[1][axis], seen[2][axis]});
        if (!(low <= half && high >= -half)) return false;
    }
    return true;
}

} // namespace

std::vector<RawPiece>
parallel_pieces(const Records& records, Vec3 direction, const Executor& executor) {
    const int axis = dominant_axis(direction);
    const int axis_u = (axis + 1) % 3;
    const int axis_v = (axis + 2) % 3;
    const Vec3d d = to_double(direction);
    const double slope_u = d[axis_u] / d[axis];
    const double slope_v = d[axis_v] / d[axis];
    const double sign = d[axis] > 0 ? 1 : -1;
    return collect(records, executor, [&](std::size_t index, std::vector<RawPiece>& pieces) {
        const PrimId id = records.ids()[index];
        RawPiece piece{};
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d p = records.vertex(id, i);
            piece.u[i] = p[axis_u] - p[axis] * slope_u;
            piece.v[i] = p[axis_v] - p[axis] * slope_v;
            piece.key[i] = static_cast<float>(p[axis] * sign);
        }
        piece.prim = id;
        pieces.push_back(piece);
    });
}

Surroundings look_around(const Records& records, const Vec3d& apex, const Executor& executor) {
    const std::vector<PrimId>& ids = records.ids();
    Surroundings around{apex};
    around.reach =
        ids.empty() ? std::numeric_limits<double>::infinity() : 4 * records.farthest_from(apex);
    around.nearest = std::max(around.reach * near_share, 0x1p-140);
    around.faces.resize(ids.size());
    std::vector<std::vector<PrimId>> near((ids.size() + chunk - 1) / chunk);
    const double half = around.nearest * (1 + 0x1p-3);
    executor.for_each_chunk(ids.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::array<Vec3d, 3> seen{
                records.vertex(ids[i], 0) - apex,
                records.vertex(ids[i], 1) - apex,
                records.vertex(ids[i], 2) - apex
            };
            around.faces[i] = only_face(seen, half);
            if (around.faces[i] == Surroundings::several && meets_cube(seen, half))
                near[begin / chunk].push_back(ids[i]);
        }
    });
    for (const auto& part : near)
        around.near.insert(around.near.end(), part.begin(), part.end());
    return around;
}

std::vector<RawPiece> radial_pieces(
    const Records& records,
    const Surroundings& around,
    std::size_t face,
    const Executor& executor
) {
    const int axis = static_cast<int>(face / 2);
    const double sign = face % 2 == 0 ? 1 : -1;
    const int axis_u = (axis + 1) % 3;
    const int axis_v = (axis + 2) % 3;
    const double nearest = around.nearest;
    return collect(records, executor, [&](std::size_t index, std::vector<RawPiece>& pieces) {
        if (around.faces[index] != face && around.faces[index] != Surroundings::several) return;
        const PrimId id = records.ids()[index];
        Polygon polygon;
        bool is_outside = true;
        bool is_inside = true;
        bool goes_on = false;
        std::array<bool, 4> beyond{true, true, true, true};
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d p = records.vertex(id, i) - around.apex;
            const Vec3d q{p[axis_u], p[axis_v], p[axis] * sign};
            const double limit = q.z * edge;
            polygon.add(q);
            is_outside = is_outside && q.z < nearest;
            goes_on = goes_on || q.z < nearest;
            is_inside =
                is_inside && q.z >= nearest && std::abs(q.x) <= limit && std::abs(q.y) <= limit;
            beyond[0] = beyond[0] && q.x > limit;
            beyond[1] = beyond[1] && -q.x > limit;
            beyond[2] = beyond[2] && q.y > limit;
            beyond[3] = beyond[3] && -q.y > limit;
        }
        if (is_outside || beyond[0] || beyond[1] || beyond[2] || beyond[3]) return;
        if (!is_inside) {
            cut(polygon, {0, 0, 1}, nearest);
            cut(polygon, {-1, 0, edge}, 0);
            cut(polygon, {1, 0, edge}, 0);
            cut(polygon, {0, -1, edge}, 0);
            cut(polygon, {0, 1, edge}, 0);
        }
        if (polygon.count < 3) return;
        const bool is_near =
            goes_on && std::binary_search(around.near.begin(), around.near.end(), id);
        double least = polygon.corners[0].z;
        for (std::size_t i = 1; i < polygon.count; ++i)
            least = std::min(least, polygon.corners[i].z);
        least = std::max(least, nearest);
        for (std::size_t i = 2; i < polygon.count; ++i) {
            RawPiece piece{};
            const std::array<std::size_t, 3> corners{0, i - 1, i};
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3d& q = polygon.corners[corners[k]];
                const double inverse = 1 / std::max(q.z, nearest);
                piece.u[k] = q.x * inverse;
                piece.v[k] = q.y * inverse;
                piece.key[k] = static_cast<float>(-inverse);
            }
            piece.margin = static_cast<float>(stray_share * around.reach / least);
            piece.prim = id;
            piece.is_part = polygon.count > 3;
            piece.is_near = is_near;
            pieces.push_back(piece);
        }
    });
}

} // namespace raywise::pencil_detail
