#include <raywise/pencil/pencil.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

Pencil Pencil::parallel(Vec3 direction) {
    if (!is_finite(direction) || direction == Vec3{}) {
        throw Error("pencil: the direction must be finite and not zero");
    }
    return {Kind::parallel, direction};
}

Pencil Pencil::radial(Vec3 apex) {
    if (!is_finite(apex)) throw Error("pencil: the apex must be finite");
    return {Kind::radial, apex};
}

} // namespace raywise
