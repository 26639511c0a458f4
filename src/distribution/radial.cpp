#include <raywise/distribution/radial.hpp>

#include "distribution/angles.hpp"
#include "distribution/checks.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/distribution/ray_distribution.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/perspective_area.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/silhouette.hpp>
#include <raywise/geometry/solid_angle.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace raywise {

namespace {

constexpr double window_area = 4; // of [-1, 1]^2

void check(const RadialParams& params) {
    require_finite(params.eye, "the eye");
    require_orthonormal(params.frame, "the eye's frame");
    require_not_negative(params.radius, "the emitter's radius");
    require_not_negative(params.start_depth, "the start depth");
    if (params.window) {
        require_positive(params.window->tan_x, "the window's horizontal tangent");
        require_positive(params.window->tan_y, "the window's vertical tangent");
        return;
    }
    require(params.emission == Emission::isotropic, "an emission without a window", "isotropic");
    require(params.start_depth == 0, "the start depth of an emission without a window", "zero");
}

/// A position in the unit ball and its share of the ball.
struct BallNode {
    Vec3d shift;
    double weight;
};

/// The center and the vertices of an icosahedron: the moments of the unit ball up to degree 5
/// (E[1] = 1, E[r^2] = 3/5, E[r^4] = 3/7). [Stroud71]
const std::array<BallNode, 13>& ball_nodes() {
    static const std::array<BallNode, 13> nodes = [] {
        std::array<BallNode, 13> result{BallNode{{}, 0.16}};
        const double scale = std::sqrt(5.0 / 7 / (1 + std::numbers::phi * std::numbers::phi));
        std::size_t count = 1;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double a : {-scale, scale}) {
                for (const double b : {-scale, scale}) {
                    Vec3d shift;
                    shift[axis] = a;
                    shift[(axis + 1) % 3] = b * std::numbers::phi;
                    result[count++] = {shift, 0.07};
                }
            }
        }
        return result;
    }();
    return nodes;
}

PerspectiveWindow window_from(const RadialParams& params, Vec3d shift) {
    return {
        .eye = params.eye + shift,
        .frame = params.frame,
        .tan_x = params.window->tan_x,
        .tan_y = params.window->tan_y,
        .near = params.start_depth
    };
}

/// The thesis drew yaw-pitch rays but measured pinhole areas.
Emission weighing_of(const RadialParams& params, MeasureMode mode) {
    return mode == MeasureMode::thesis ? Emission::pinhole : params.emission;
}

bool holds(const Aabb& box, Vec3d point) {
    return view_from(box, point) == view_inside;
}

/// The box's shadow on the plane of the window, uncut; nullopt when it reaches the eye's plane.
std::optional<ConvexPolygon> whole_shadow(const PerspectiveView& view, const Aabb& box) {
    for (int i = 0; i < 8; ++i)
        if (!(view.to_view(to_double(box.vertex(i))).z > 0)) return std::nullopt;
    ConvexPolygon shadow;
    const Silhouette& outline = silhouette(view_from(box, view.window().eye));
    for (std::size_t i = 0; i < outline.size; ++i) {
        const Vec3d at = view.to_view(to_double(box.vertex(outline.vertices[i])));
        shadow.push_back({at.x / at.z, at.y / at.z});
    }
    return shadow;
}

} // namespace

RadialWindow window_of_fov(double fov_x_deg, double fov_y_deg) {
    const auto tangent = [](double fov_deg, const char* name) {
        require(fov_deg > 0 && fov_deg < 180, name, "in (0, 180) degrees");
        return std::tan(to_radians(fov_deg) / 2);
    };
    return {
        .tan_x = tangent(fov_x_deg, "the horizontal field of view"),
        .tan_y = tangent(fov_y_deg, "the vertical field of view")
    };
}

double RadialMeasure::AllAround::operator()(const Aabb& box) const {
    return solid_angle_sr(box, eye) / (4 * std::numbers::pi);
}

RadialMeasure::Sight RadialMeasure::sight_from(
    const RadialParams& params,
    Vec3d shift,
    double weight,
    MeasureMode mode
) {
    if (!params.window) return {AllAround{params.eye + shift}, weight};
    const PerspectiveWindow window = window_from(params, shift);
    switch (weighing_of(params, mode)) {
    case Emission::pinhole:
        return {PerspectiveProjection(window), weight};
    case Emission::isotropic:
        return {SolidAngleProjection(window), weight};
    case Emission::yaw_pitch:
        break;
    }
    return {YawPitchProjection(window), weight};
}

RadialMeasure::RadialMeasure(const RadialParams& params, MeasureMode mode)
    : eye_(params.eye), mode_(mode), weighing_(weighing_of(params, mode)) {
    check(params);
    if (params.window) {
        view_.emplace(window_from(params, {}));
        window_sr_ = window_solid_angle_sr(params.window->tan_x, params.window->tan_y);
    }
    std::vector<Sight> sights;
    if (params.radius == 0 || mode == MeasureMode::thesis) {
        sights.push_back(sight_from(params, {}, 1, mode));
    } else {
        for (const BallNode& node : ball_nodes())
            sights.push_back(sight_from(params, node.shift * params.radius, node.weight, mode));
    }
    sights_ = std::make_shared<const std::vector<Sight>>(std::move(sights));
}

float RadialMeasure::operator()(const Aabb& box) const {
    if (box.is_empty()) return 0;
    if (inside_) return static_cast<float>(inside_share(box));
    if (mode_ == MeasureMode::thesis && holds(box, eye_)) return 0;
    double sum = 0;
    for (const Sight& sight : *sights_)
        sum += sight.weight *
               std::visit([&box](const auto& share) { return share(box); }, sight.share);
    return static_cast<float>(std::clamp(sum, 0.0, 1.0));
}

double RadialMeasure::inside_share(const Aabb& box) const {
    if (weighing_ == Emission::pinhole) return view_->inside_share(box);
    return std::min(solid_angle_sr(box, eye_) / window_sr_, 1.0);
}

RadialMeasure RadialMeasure::narrowed(const Aabb& box) const {
    RadialMeasure result = *this;
    const bool has_closed_form = view_ && weighing_ != Emission::yaw_pitch && sights_->size() == 1;
    if (has_closed_form && view_->relation(box) == PerspectiveView::Relation::inside)
        result.inside_ = true;
    return result;
}

std::optional<double> RadialMeasure::shared(const Aabb& a, const Aabb& b) const {
    if (!view_) return std::nullopt;
    if (a.is_empty() || b.is_empty()) return 0;
    const bool a_around = view_->relation(a) == PerspectiveView::Relation::around;
    const bool b_around = view_->relation(b) == PerspectiveView::Relation::around;
    if (a_around && b_around) return 1;
    if (a_around || b_around)
        return view_->sum_over_shadow(a_around ? b : a, [](const ConvexPolygon& piece) {
            return area(piece) / window_area;
        });
    return view_->sum_over_shadow(a, [&](const ConvexPolygon& piece_of_a) {
        return view_->sum_over_shadow(b, [&piece_of_a](const ConvexPolygon& piece_of_b) {
            return area(intersect(piece_of_a, piece_of_b)) / window_area;
        });
    });
}

double RadialMeasure::unculled(const Aabb& box) const {
    if (box.is_empty()) return 0;
    if (!view_) return AllAround{eye_}(box);
    const auto shadow = whole_shadow(*view_, box);
    return shadow ? area(*shadow) / window_area : std::numeric_limits<double>::infinity();
}

std::optional<double> RadialMeasure::unculled_shared(const Aabb& a, const Aabb& b) const {
    if (!view_) return std::nullopt;
    if (a.is_empty() || b.is_empty()) return 0;
    const auto shadow_of_a = whole_shadow(*view_, a);
    const auto shadow_of_b = whole_shadow(*view_, b);
    if (!shadow_of_a || !shadow_of_b) return std::nullopt;
    return area(intersect(*shadow_of_a, *shadow_of_b)) / window_area;
}

RadialDistribution::RadialDistribution(const RadialParams& params) : params_(params) {
    check(params);
}

namespace {

Vec3d draw_direction(const RadialParams& params, Rng& rng) {
    if (!params.window) return sample_sphere(rng);
    const auto [tan_x, tan_y] = *params.window;
    switch (params.emission) {
    case Emission::pinhole:
        return normalized(sample_pinhole(params.frame, tan_x, tan_y, rng));
    case Emission::isotropic:
        return sample_isotropic(params.frame, tan_x, tan_y, rng);
    case Emission::yaw_pitch:
        break;
    }
    return sample_square_cap(params.frame, std::atan(tan_x), std::atan(tan_y), rng);
}

} // namespace

Ray RadialDistribution::sample(Rng& rng) const {
    const Vec3d direction = draw_direction(params_, rng);
    Vec3d origin = params_.eye;
    if (params_.radius > 0)
        origin = origin + sample_sphere(rng) * (params_.radius * std::cbrt(rng.uniform_double()));
    if (params_.start_depth > 0)
        origin = origin + direction * (params_.start_depth / dot(direction, params_.frame.forward));
    return {.origin = to_float(origin), .direction = to_float(direction)};
}

double RadialDistribution::density(const Ray& ray) const {
    if (!is_valid(ray)) return 0;
    if (!params_.window) return 1 / (4 * std::numbers::pi);
    const Vec3d direction = to_double(ray.direction);
    const auto [tan_x, tan_y] = *params_.window;
    switch (params_.emission) {
    case Emission::pinhole:
        return pinhole_density_per_sr(params_.frame, tan_x, tan_y, direction);
    case Emission::isotropic:
        return isotropic_density_per_sr(params_.frame, tan_x, tan_y, direction);
    case Emission::yaw_pitch:
        break;
    }
    return square_cap_density_per_sr(params_.frame, std::atan(tan_x), std::atan(tan_y), direction);
}

Vec3d RadialDistribution::direction_at(const Aabb& box) const {
    const Vec3d center = (to_double(box.lo) + to_double(box.hi)) * 0.5;
    const Vec3d toward = center - params_.eye;
    if (!is_finite(toward) || toward == Vec3d{}) return params_.frame.forward;
    return toward;
}

} // namespace raywise
