// Stands in where Embree was not found when the program was configured.
#include "embree.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <span>
#include <string>

namespace raywise::app {

struct EmbreePeer::State {};

struct PeerRays::Layouts {};

namespace {

[[noreturn]] void refuse() {
    throw Error(
        "this raywise was built without Embree (libembree-dev), which bench measures against"
    );
}

} // namespace

bool has_embree() {
    return false;
}

std::string embree_version() {
    return {};
}

EmbreePeer::EmbreePeer(const Scene&, const PeerParams&) {
    refuse();
}

EmbreePeer::~EmbreePeer() = default;
EmbreePeer::EmbreePeer(EmbreePeer&&) noexcept = default;
EmbreePeer& EmbreePeer::operator=(EmbreePeer&&) noexcept = default;

// NOLINTBEGIN(*-to-static): the same class as with Embree
double EmbreePeer::build_ms() const {
    return 0;
}

std::size_t EmbreePeer::bytes() const {
    return 0;
}
// NOLINTEND(*-to-static)

PeerRays::PeerRays(std::span<const Ray>) {
    refuse();
}

PeerRays::~PeerRays() = default;
PeerRays::PeerRays(PeerRays&&) noexcept = default;
PeerRays& PeerRays::operator=(PeerRays&&) noexcept = default;

void PeerRays::occluded(const EmbreePeer&, const PeerCall&, std::span<bool>, const Executor&)
    const {}

void PeerRays::closest(const EmbreePeer&, const PeerCall&, std::span<Hit>, const Executor&) const {}

} // namespace raywise::app
