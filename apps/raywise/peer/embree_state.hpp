// What an EmbreePeer holds. Only for the files that include Embree's own headers.
#pragma once

#include "embree.hpp"

#include <embree3/rtcore.h>

#include <atomic>
#include <cstddef>
#include <vector>

namespace raywise::app {

struct EmbreePeer::State {
    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    State(State&&) = delete;
    State& operator=(State&&) = delete;

    ~State() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }

    std::vector<Vec3> vertices; ///< padded
    std::atomic<std::ptrdiff_t> held = 0;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    double build_ms = 0;
    std::size_t bytes = 0;
};

} // namespace raywise::app
