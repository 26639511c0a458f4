#include <raywise/geometry/ray_triangle.hpp>

#include "geometry/detail/expansion.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

// With a, b, c the vertices as seen from the origin and d the direction, the line meets the
// triangle's plane at the weights U : V : W = d.(b x c) : d.(c x a) : d.(a x b), at
// t = a.(b x c) / (U + V + W).
namespace raywise {

namespace {

using detail::Expansion;

/// A double and how far the exact value may be from it.
struct Bounded {
    double value;
    double error;

    [[nodiscard]] bool has_sure_sign() const { return std::abs(value) > error || error == 0; }

    /// When it is sure.
    [[nodiscard]] int sign() const {
        return static_cast<int>(value > 0) - static_cast<int>(value < 0);
    }
};

/// p . (q x r). Each product of three carries the roundings of its factors, at most three, and its
/// own four; summed, at most gamma(9) of the sum of their magnitudes. 12 units are granted, for the
/// rounding of that sum. No under- or overflow: products of three differences of floats stay within
/// 2^-447 and 2^390.
Bounded triple_product(const Vec3d& p, const Vec3d& q, const Vec3d& r) {
    const double yz = q.y * r.z, zy = q.z * r.y;
    const double zx = q.z * r.x, xz = q.x * r.z;
    const double xy = q.x * r.y, yx = q.y * r.x;
    const double value = p.x * (yz - zy) + p.y * (zx - xz) + p.z * (xy - yx);
    const double size = std::abs(p.x) * (std::abs(yz) + std::abs(zy)) +
                        std::abs(p.y) * (std::abs(zx) + std::abs(xz)) +
                        std::abs(p.z) * (std::abs(xy) + std::abs(yx));
    return {value, 12 * 0x1p-53 * size};
}

using Exact2 = Expansion<2>;

struct ExactVec {
    Exact2 x, y, z;
};

ExactVec exact_difference(Vec3 a, Vec3 b) {
    return {
        detail::difference(a.x, b.x), detail::difference(a.y, b.y), detail::difference(a.z, b.z)
    };
}

using ExactVolume = Expansion<192>;

ExactVolume exact_triple_product(const ExactVec& p, const ExactVec& q, const ExactVec& r) {
    const auto x = detail::compress(q.y * r.z - q.z * r.y) * p.x;
    const auto y = detail::compress(q.z * r.x - q.x * r.z) * p.y;
    const auto z = detail::compress(q.x * r.y - q.y * r.x) * p.z;
    return detail::compress(x + y + z);
}

/// The nearest float to num / den > or < 0 exactly, ties to even; +inf or -inf beyond the floats.
/// den != 0.
template <std::size_t N, std::size_t M>
float nearest_quotient(const Expansion<N>& num, const Expansion<M>& den) {
    const double estimate = num.estimate() / den.estimate(); // within 2^-49
    const auto nearest = static_cast<float>(estimate);
    const double rest = estimate - static_cast<double>(nearest);
    if (rest == 0) return nearest; // a float itself is far from every midpoint
    constexpr float infinity = std::numeric_limits<float>::infinity();
    // The midpoint that the estimate is next to, and the float on its other side.
    constexpr double overflow = 0x1.FFFFFFp127; // midpoint of the largest float and 2^128
    float other = std::nextafter(nearest, rest > 0 ? infinity : -infinity);
    double middle = (static_cast<double>(nearest) + static_cast<double>(other)) / 2;
    if (std::isinf(nearest)) {
        other = std::copysign(std::numeric_limits<float>::max(), nearest);
        middle = std::copysign(overflow, static_cast<double>(nearest));
    } else if (std::isinf(other)) {
        middle = std::copysign(overflow, static_cast<double>(other));
    }
    if (std::abs(estimate - middle) > 0x1p-45 * std::abs(middle)) return nearest;
    const int above = (num - den * middle).sign() * den.sign();
    if (above != 0) return above > 0 ? std::max(nearest, other) : std::min(nearest, other);
    // A tie goes to the even one, which is the only one of the two that twice its spacing divides.
    return static_cast<float>(middle);
}

double largest_size(const Vec3d& v) {
    // NOLINTNEXTLINE(modernize-min-max-use-initializer-list): lists go through memory.
    return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
}

/// The weights from edges instead of vertices: V = e2.(a x d), W = e1.(d x a), U + V + W = d.(e1 x
/// e2), t = a.(e1 x e2) / d.(e1 x e2), for the edges from a. What cancels when a triangle is far
/// and small has canceled exactly before anything is multiplied. Each product of three has at most
/// three rounded factors and four roundings of its own, and there are six of them: errors are
/// below 12 * 6 units of the product of the largest components, as in triple_product.
struct EdgeForm {
    double v, w, sum, volume;
    double v_error, w_error, sum_error, volume_error;

    EdgeForm(const Ray& ray, const Triangle& triangle) {
        const Vec3d v0 = to_double(triangle.v0);
        const Vec3d a = v0 - to_double(ray.origin);
        const Vec3d e1 = to_double(triangle.v1) - v0;
        const Vec3d e2 = to_double(triangle.v2) - v0;
        const Vec3d d = to_double(ray.direction);
        const Vec3d normal = cross(e1, e2);
        const Vec3d moment = cross(a, d);
        sum = dot(d, normal);
        volume = dot(a, normal);
        v = dot(e2, moment);
        w = -dot(e1, moment);

        constexpr double unit = 72 * 0x1p-53;
        const double size_e1 = largest_size(e1);
        const double size_e2 = largest_size(e2);
        const double reach = unit * largest_size(a);
        const double slope = largest_size(d);
        const double face = size_e1 * size_e2;
        const double edge = reach * slope;
        sum_error = unit * slope * face;
        volume_error = reach * face;
        v_error = edge * size_e2;
        w_error = edge * size_e1;
    }

    /// Good to 2^-22: where their own errors are small beside the sum.
    [[nodiscard]] bool has_good_weights() const {
        const double least_sum = std::abs(sum) * 0x1p-26;
        return sum_error <= least_sum * 0x1p-5 && v_error <= least_sum && w_error <= least_sum;
    }

    [[nodiscard]] Hit hit(float t, PrimId id) const {
        const double inverse = 1 / sum;
        const auto weight = [&](double part) {
            return static_cast<float>(std::clamp(part * inverse, 0.0, 1.0));
        };
        // Adding +0 turns -0 into +0.
        return {t + 0.0F, weight(v), weight(w), id, sum < 0};
    }
};

/// What double precision can tell without asking where exactly its errors come from: whether that
/// is sure, and then fills `hit` if there is one. Not sure when a vertex is not finite.
bool look(
    const Ray& ray,
    const Triangle& triangle,
    PrimId id,
    float t_max,
    std::optional<Hit>& hit
) {
    const EdgeForm form(ray, triangle);
    const auto [v, w, sum, volume, v_error, w_error, sum_error, volume_error] = form;
    const double u = sum - v - w;
    // 1 + 2^-10 covers the two subtractions and the roundings of the bounds.
    const double u_error = (sum_error + v_error + w_error) * (1 + 0x1p-10) +
                           0x1p-50 * (std::abs(sum) + std::abs(v) + std::abs(w));
    const bool are_sure = std::abs(u) > u_error && std::abs(v) > v_error && std::abs(w) > w_error;
    if (!are_sure) {
        // One sure sign on each side is a miss, whatever the third.
        const bool is_above = u > u_error || v > v_error || w > w_error;
        const bool is_below = u < -u_error || v < -v_error || w < -w_error;
        return is_above && is_below;
    }
    if ((u > 0) != (v > 0) || (v > 0) != (w > 0)) return true;
    if (!form.has_good_weights()) return false;

    const double inverse = 1 / sum;
    const double t = volume * inverse;
    const double error =
        (volume_error + std::abs(t) * sum_error) * std::abs(inverse) * (1 + 0x1p-20) +
        0x1p-50 * std::abs(t);
    const auto low = static_cast<float>(t - error);
    const auto high = static_cast<float>(t + error);
    if (high < ray.t_min || low > t_max) return true;
    if (low != high || !(high <= std::numeric_limits<float>::max())) return false;
    if (!(low >= ray.t_min && low <= t_max)) return true;
    hit.emplace(form.hit(low, id));
    return true;
}

/// One triangle, decided step by step; the steps after the first are rare.
class Decision {
public:
    Decision(const Ray& ray, const Triangle& triangle) : ray_(ray), triangle_(triangle) {
        const Vec3d o = to_double(ray.origin);
        a_ = to_double(triangle.v0) - o;
        b_ = to_double(triangle.v1) - o;
        c_ = to_double(triangle.v2) - o;
        const Vec3d d = to_double(ray.direction);
        weights_ = {
            triple_product(d, b_, c_), triple_product(d, c_, a_), triple_product(d, a_, b_)
        };
    }

    [[nodiscard]] std::optional<Hit> hit(PrimId id, float t_max) {
        const int side = common_side();
        if (side == 0) return std::nullopt;
        const Bounded sum = weight_sum();
        const std::optional<float> t = nearest_t(sum, t_max);
        if (!t || !(*t >= ray_.t_min && *t <= t_max) || std::isinf(*t)) return std::nullopt;
        // Where they are good, the weights do not depend on how the rest was decided.
        if (const EdgeForm form(ray_, triangle_); form.has_good_weights()) return form.hit(*t, id);
        const auto weight = [&](const Bounded& part) {
            return static_cast<float>(std::clamp(part.value / sum.value, 0.0, 1.0));
        };
        // Adding +0 turns -0 into +0.
        return Hit{*t + 0.0F, weight(weights_[1]), weight(weights_[2]), id, side < 0};
    }

private:
    /// The sign that all nonzero weights have; 0 when they differ or all are zero.
    [[nodiscard]] int common_side() {
        bool has_positive = false;
        bool has_negative = false;
        const auto note = [&](const Bounded& weight) {
            has_positive = has_positive || weight.sign() > 0;
            has_negative = has_negative || weight.sign() < 0;
        };
        for (const Bounded& weight : weights_)
            if (weight.has_sure_sign()) note(weight);
        for (std::size_t i = 0; i < 3 && !(has_positive && has_negative); ++i) {
            if (weights_[i].has_sure_sign()) continue;
            make_exact(i);
            note(weights_[i]);
        }
        return static_cast<int>(has_positive) - static_cast<int>(has_negative);
    }

    /// U + V + W, all of one sign, to better than 2^-30, so that u and v are good floats.
    [[nodiscard]] Bounded weight_sum() {
        const auto sum = [this] {
            const auto& [u, v, w] = weights_;
            const double value = u.value + v.value + w.value;
            return Bounded{
                value, (u.error + v.error + w.error) * (1 + 0x1p-50) + 0x1p-51 * std::abs(value)
            };
        };
        if (const Bounded s = sum(); s.error <= 0x1p-30 * std::abs(s.value)) return s;
        make_all_exact();
        return sum();
    }

    /// t rounded to float; nothing when it is surely outside [t_min, t_max].
    [[nodiscard]] std::optional<float> nearest_t(const Bounded& sum, float t_max) {
        const Bounded volume = triple_product(a_, b_, c_);
        const double t = volume.value / sum.value;
        const double error = (volume.error + std::abs(t) * sum.error) /
                                 (std::abs(sum.value) - sum.error) * (1 + 0x1p-40) +
                             0x1p-51 * std::abs(t);
        const auto low = static_cast<float>(t - error);
        const auto high = static_cast<float>(t + error);
        if (low == high) return low;
        if (high < ray_.t_min || low > t_max) return std::nullopt;
        make_all_exact();
        return nearest_quotient(
            exact_triple_product(exact_a_, exact_b_, exact_c_), exact_[0] + exact_[1] + exact_[2]
        );
    }

    void make_exact(std::size_t weight) {
        if (is_exact_[weight]) return;
        is_exact_[weight] = true;
        if (!has_exact_vertices_) {
            has_exact_vertices_ = true;
            exact_a_ = exact_difference(triangle_.v0, ray_.origin);
            exact_b_ = exact_difference(triangle_.v1, ray_.origin);
            exact_c_ = exact_difference(triangle_.v2, ray_.origin);
        }
        const ExactVec d = exact_difference(ray_.direction, Vec3{});
        const std::array<const ExactVec*, 4> around{&exact_b_, &exact_c_, &exact_a_, &exact_b_};
        exact_[weight] = exact_triple_product(d, *around[weight], *around[weight + 1]);
        const double value = exact_[weight].estimate();
        weights_[weight] = {value, 0x1p-51 * std::abs(value)};
    }

    void make_all_exact() {
        for (std::size_t i = 0; i < 3; ++i)
            make_exact(i);
    }

    const Ray& ray_;
    const Triangle& triangle_;
    Vec3d a_, b_, c_;
    std::array<Bounded, 3> weights_{}; ///< U, V, W
    std::array<bool, 3> is_exact_{};
    bool has_exact_vertices_ = false;
    ExactVec exact_a_, exact_b_, exact_c_;
    std::array<ExactVolume, 3> exact_;
};

} // namespace

ExactKernel::ExactKernel(const Ray& ray) : ray_(&ray) {
    const int z = dominant_axis(ray.direction);
    const int x = (z + 1) % 3;
    const int y = (z + 2) % 3;
    const auto offset = [](int axis) { return static_cast<std::size_t>(axis) * sizeof(float); };
    x_ = offset(x);
    y_ = offset(y);
    z_ = offset(z);
    origin_x_ = ray.origin[x];
    origin_y_ = ray.origin[y];
    origin_z_ = ray.origin[z];
    shear_x_ = ray.direction[x] / ray.direction[z];
    shear_y_ = ray.direction[y] / ray.direction[z];
}

std::optional<Hit>
ExactKernel::decide(const Ray& ray, const Triangle& triangle, PrimId id, float t_max) {
    // One result from the first write to the last reader: copies of what was just written stall.
    std::optional<Hit> hit;
    if (look(ray, triangle, id, t_max, hit)) [[likely]]
        return hit;
    if (is_finite(triangle.v0) && is_finite(triangle.v1) && is_finite(triangle.v2))
        hit = Decision(ray, triangle).hit(id, t_max);
    return hit;
}

std::optional<Hit> intersect(const Ray& ray, const Triangle& triangle, PrimId id, FaceMode faces) {
    if (!is_valid(ray) || id == ray.excluded) return std::nullopt;
    const std::optional<Hit> hit = ExactKernel::decide(ray, triangle, id, ray.t_max);
    return hit && (faces == FaceMode::both || hit->front) ? hit : std::nullopt;
}

} // namespace raywise
