#include <raywise/geometry/solid_angle.hpp>

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/perspective_area.hpp>
#include <raywise/geometry/silhouette.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace raywise {

namespace {

/// Solid angle of a convex polygon seen from the origin outside its plane, as a fan of triangles.
/// Half the solid angle of each is the argument of a complex number, so that of the polygon, below
/// pi, is the argument of their product: one arc tangent for all. Each determinant is taken of the
/// edges, so that a small triangle far away keeps its digits. [VanOosterom83]
class SolidAngleFan {
public:
    SolidAngleFan(Vec3d first, Vec3d second)
        : first_(first)
        , last_(second)
        , first_length_(length(first))
        , last_length_(length(second)) {}

    void add(Vec3d corner) {
        const double corner_length = length(corner);
        const double scale = 1 / (first_length_ * last_length_ * corner_length);
        const double y = scale * dot(first_, cross(last_ - first_, corner - first_));
        const double x =
            1 + scale * (dot(first_, last_) * corner_length + dot(last_, corner) * first_length_ +
                         dot(corner, first_) * last_length_);
        const double real = real_ * x - imaginary_ * y;
        imaginary_ = real_ * y + imaginary_ * x;
        real_ = real;
        last_ = corner;
        last_length_ = corner_length;
    }

    [[nodiscard]] double solid_angle_sr() const {
        return 2 * std::abs(std::atan2(imaginary_, real_));
    }

private:
    Vec3d first_;
    Vec3d last_;
    double first_length_;
    double last_length_;
    double real_ = 1;
    double imaginary_ = 0;
};

Vec3d on_image_plane(Vec2d p) {
    return {p.x, p.y, 1};
}

/// The polygon with its coordinates multiplied by (x, y).
ConvexPolygon scaled(const ConvexPolygon& polygon, double x, double y) {
    ConvexPolygon result;
    for (const Vec2d p : polygon)
        result.push_back({p.x * x, p.y * y});
    return result;
}

/// The pitch along a line y = slope x + offset of the image plane, per unit of yaw = atan x:
/// atan(y / sqrt(1 + x^2)) / (1 + x^2) as a function of x.
struct PitchDensity {
    Vec2d start; ///< a point of the line
    double slope;

    [[nodiscard]] double operator()(double x) const {
        const double squared = 1 + x * x;
        return std::atan((start.y + slope * (x - start.x)) / std::sqrt(squared)) / squared;
    }

    /// Parameter of the largest Bernstein ellipse around [from, to] in which the density is
    /// analytic: n Gauss points err like rho^(-2n). It is singular where 1 + x^2 = 0 and where
    /// 1 + x^2 + y^2 = 0.
    [[nodiscard]] double bernstein_rho(double from, double to) const {
        const double middle = (from + to) / 2;
        const double half = std::abs(to - from) / 2;
        const double steepness = 1 + slope * slope;
        const double offset = start.y - slope * start.x;
        const double real = -slope * offset / steepness;
        const double imaginary = std::sqrt(steepness + offset * offset) / steepness;
        const double sum = std::min(
            sum_to_foci(-middle / half, 1 / half),
            sum_to_foci((real - middle) / half, imaginary / half)
        );
        return sum + std::sqrt(std::max(sum * sum - 1, 0.0));
    }

private:
    /// Half the sum of the distances from (x, y) to -1 and 1.
    static double sum_to_foci(double x, double y) {
        return (std::sqrt((x - 1) * (x - 1) + y * y) + std::sqrt((x + 1) * (x + 1) + y * y)) / 2;
    }
};

/// The positive nodes of Gauss-Legendre rules of twice as many points, with their weights, and from
/// which ellipse on a rule errs by less than 1e-9 per unit.
struct GaussRule {
    double least_rho;
    std::size_t pairs;
    std::array<double, 4> nodes;
    std::array<double, 4> weights;
};

constexpr std::array<GaussRule, 3> gauss_rules{{
    {260, 1, {0.5773502691896258}, {1}},
    {16, 2, {0.3399810435848563, 0.8611363115940526}, {0.6521451548625461, 0.3478548451374538}},
    {4,
     4,
     {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363},
     {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763}},
}};

double integrate(const PitchDensity& density, double from, double to, const GaussRule& rule) {
    const double middle = (from + to) / 2;
    const double half = (to - from) / 2;
    double sum = 0;
    for (std::size_t i = 0; i < rule.pairs; ++i)
        sum += rule.weights[i] *
               (density(middle - half * rule.nodes[i]) + density(middle + half * rule.nodes[i]));
    return sum * half;
}

/// Halved until a rule is good enough; only towards a singularity are halves halved again.
double integrate(const PitchDensity& density, double from, double to, int halvings = 48) {
    if (from == to) return 0;
    const double rho = density.bernstein_rho(from, to);
    for (const GaussRule& rule : gauss_rules)
        if (rho >= rule.least_rho) return integrate(density, from, to, rule);
    if (halvings == 0) return integrate(density, from, to, gauss_rules.back());
    const double middle = (from + to) / 2;
    return integrate(density, from, middle, halvings - 1) +
           integrate(density, middle, to, halvings - 1);
}

/// Parameters in (0, 1) at which the edge from p to q crosses |pitch| = limit, between 0 and 1 in
/// order: where y^2 = limit^2 (1 + x^2).
struct Cuts {
    std::array<double, 4> at{0, 1, 1, 1};
    std::size_t size = 2;
};

Cuts cut_at_pitch(Vec2d p, Vec2d q, double tan_limit) {
    const Vec2d d = q - p;
    const double limit = tan_limit * tan_limit;
    const double a = d.y * d.y - limit * d.x * d.x;
    const double b = p.y * d.y - limit * p.x * d.x; // half the linear coefficient
    const double c = p.y * p.y - limit * (1 + p.x * p.x);
    const double discriminant = b * b - a * c;
    Cuts cuts;
    if (!(discriminant > 0)) return cuts;
    const double s = -(b + std::copysign(std::sqrt(discriminant), b));
    std::array<double, 2> roots{a != 0 ? s / a : -1, s != 0 ? c / s : -1};
    std::sort(roots.begin(), roots.end());
    cuts.size = 1;
    for (const double root : roots)
        if (root > 0 && root < 1) cuts.at[cuts.size++] = root;
    cuts.at[cuts.size++] = 1;
    return cuts;
}

/// The largest pitch that counts.
struct PitchLimit {
    double angle_rad;
    double tangent;
};

/// Integral of the pitch, held within +- limit, over the yaw along the edge from p to q.
double integrate_edge(Vec2d p, Vec2d q, const PitchLimit& limit) {
    if (p.x == q.x) return 0;
    const PitchDensity density{p, (q.y - p.y) / (q.x - p.x)};
    const Cuts cuts = cut_at_pitch(p, q, limit.tangent);
    double sum = 0;
    for (std::size_t i = 0; i + 1 < cuts.size; ++i) {
        const double from = p.x + (q.x - p.x) * cuts.at[i];
        const double to = p.x + (q.x - p.x) * cuts.at[i + 1];
        const Vec2d middle = p + (q - p) * ((cuts.at[i] + cuts.at[i + 1]) / 2);
        const bool held = std::abs(middle.y) > limit.tangent * std::sqrt(1 + middle.x * middle.x);
        sum += held ? std::copysign(limit.angle_rad, middle.y) * (std::atan(to) - std::atan(from))
                    : integrate(density, from, to);
    }
    return sum;
}

/// A window that every ray of the window's square cap passes.
PerspectiveWindow around_square_cap(PerspectiveWindow window) {
    window.tan_y *= std::hypot(1.0, window.tan_x);
    return window;
}

} // namespace

double solid_angle_sr(const Aabb& box, Vec3d eye) {
    if (box.is_empty()) return 0;
    const Silhouette& cycle = silhouette(view_from(box, eye));
    if (cycle.size == 0) return 4 * std::numbers::pi;
    const auto corner = [&](std::size_t i) {
        return to_double(box.vertex(cycle.vertices[i])) - eye;
    };
    SolidAngleFan fan(corner(0), corner(1));
    for (std::size_t i = 2; i < cycle.size; ++i)
        fan.add(corner(i));
    return fan.solid_angle_sr();
}

double window_solid_angle_sr(double tan_x, double tan_y) {
    const double sine_x = tan_x / std::hypot(1.0, tan_x);
    const double sine_y = tan_y / std::hypot(1.0, tan_y);
    return 4 * std::asin(sine_x * sine_y);
}

double polygon_solid_angle_sr(const ConvexPolygon& polygon) {
    if (polygon.size() < 3) return 0;
    SolidAngleFan fan(on_image_plane(polygon[0]), on_image_plane(polygon[1]));
    for (std::size_t i = 2; i < polygon.size(); ++i)
        fan.add(on_image_plane(polygon[i]));
    return fan.solid_angle_sr();
}

double polygon_yaw_pitch_rad2(const ConvexPolygon& polygon, double pitch_limit_rad) {
    if (polygon.size() < 3) return 0;
    const PitchLimit limit{pitch_limit_rad, std::tan(pitch_limit_rad)};
    double sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        sum += integrate_edge(polygon[i], polygon.after(i), limit);
    return std::abs(sum);
}

SolidAngleProjection::SolidAngleProjection(const PerspectiveWindow& window)
    : view_(window), window_sr_(window_solid_angle_sr(window.tan_x, window.tan_y)) {}

double SolidAngleProjection::operator()(const Aabb& box) const {
    const double share = view_.sum_over_shadow(box, [&](const ConvexPolygon& piece) {
        return polygon_solid_angle_sr(scaled(piece, window().tan_x, window().tan_y)) / window_sr_;
    });
    return std::clamp(share, 0.0, 1.0);
}

YawPitchProjection::YawPitchProjection(const PerspectiveWindow& window)
    : window_(window)
    , view_(around_square_cap(window))
    , yaw_limit_rad_(std::atan(window.tan_x))
    , pitch_limit_rad_(std::atan(window.tan_y)) {}

double YawPitchProjection::operator()(const Aabb& box) const {
    const PerspectiveWindow& wide = view_.window();
    const double share = view_.sum_over_shadow(box, [&](const ConvexPolygon& piece) {
        const ConvexPolygon on_plane = scaled(piece, wide.tan_x, wide.tan_y);
        return polygon_yaw_pitch_rad2(on_plane, pitch_limit_rad_) /
               (4 * yaw_limit_rad_ * pitch_limit_rad_);
    });
    return std::clamp(share, 0.0, 1.0);
}

} // namespace raywise
