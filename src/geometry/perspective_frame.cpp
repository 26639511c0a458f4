#include <raywise/geometry/perspective_frame.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>

#include <cmath>

namespace raywise {

PerspectiveFrame::PerspectiveFrame(Vec3d apex, int axis, int sign)
    : apex_(apex), axis_(axis), sign_(sign) {
    if (!is_finite(apex)) throw Error("the apex of a frame must be finite");
    if (axis < 0 || axis > 2) throw Error("a world axis is 0, 1 or 2");
    if (sign != 1 && sign != -1) throw Error("the side of a cube face is +1 or -1");
}

PerspectiveFrame PerspectiveFrame::facing(Vec3d apex, Vec3d direction) {
    if (!is_finite(direction) || direction == Vec3d{})
        throw Error("a direction must be finite and not zero");
    const int axis = dominant_axis(direction);
    return {apex, axis, direction[axis] < 0 ? -1 : 1};
}

bool PerspectiveFrame::contains(Vec3d point) const {
    const Vec3d from_apex = point - apex_;
    const double z = depth(point);
    return z > 0 && std::abs(from_apex[u_axis()]) <= z && std::abs(from_apex[v_axis()]) <= z;
}

} // namespace raywise
