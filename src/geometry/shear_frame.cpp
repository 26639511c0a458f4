#include <raywise/geometry/shear_frame.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

ShearFrame::ShearFrame(Vec3d direction)
    : axis_(dominant_axis(direction))
    , sign_(direction[axis_] < 0 ? -1 : 1)
    , slope_u_(direction[u_axis()] / direction[axis_])
    , slope_v_(direction[v_axis()] / direction[axis_]) {
    if (!is_finite(direction) || direction == Vec3d{})
        throw Error("a direction must be finite and not zero");
}

} // namespace raywise
