#include <raywise/analysis/ray_class.hpp>

#include <array>
#include <span>
#include <string_view>

namespace raywise {

namespace {

constexpr std::array classes_in_order = {
    RayClass::primary,
    RayClass::sun,
    RayClass::point_light,
    RayClass::sun_disc_027,
    RayClass::sun_disc_2,
    RayClass::area_light,
    RayClass::thin_lens,
    RayClass::diffuse_bounce,
};

} // namespace

std::span<const RayClass> all_ray_classes() {
    return classes_in_order;
}

std::string_view name_of(RayClass rays) {
    switch (rays) {
    case RayClass::primary:
        return "primary";
    case RayClass::sun:
        return "sun";
    case RayClass::point_light:
        return "point_light";
    case RayClass::sun_disc_027:
        return "sun_disc_0.27";
    case RayClass::sun_disc_2:
        return "sun_disc_2";
    case RayClass::area_light:
        return "area_light";
    case RayClass::thin_lens:
        return "thin_lens";
    case RayClass::diffuse_bounce:
        break;
    }
    return "diffuse_bounce";
}

std::string_view name_of(RayKind kind) {
    switch (kind) {
    case RayKind::exact:
        return "exact";
    case RayKind::near_affine:
        return "near_affine";
    case RayKind::general:
        break;
    }
    return "general";
}

RayKind kind_of(RayClass rays) {
    switch (rays) {
    case RayClass::primary:
    case RayClass::sun:
    case RayClass::point_light:
        return RayKind::exact;
    case RayClass::diffuse_bounce:
        return RayKind::general;
    default:
        return RayKind::near_affine;
    }
}

bool asks_closest(RayClass rays) {
    return is_camera(rays) || rays == RayClass::diffuse_bounce;
}

bool is_sun(RayClass rays) {
    return rays == RayClass::sun || rays == RayClass::sun_disc_027 || rays == RayClass::sun_disc_2;
}

bool is_camera(RayClass rays) {
    return rays == RayClass::primary || rays == RayClass::thin_lens;
}

} // namespace raywise
