#include "embree_state.hpp"
#include "peer/embree.hpp"

#include <raywise/analysis/stopwatch.hpp>
#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <string>

namespace raywise::app {

namespace {

std::string instruction_set(RTCDevice device) {
    const auto has = [&](RTCDeviceProperty property) {
        return rtcGetDeviceProperty(device, property) != 0;
    };
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return "AVX-512";
    if (!has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) return "SSE";
#if defined(__x86_64__)
    if (!__builtin_cpu_supports("avx2")) return "AVX";
#endif
    return "AVX2";
}

std::string version_of(RTCDevice device) {
    const auto number = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
    return fmt::format(
        "{}.{}.{}, {}", number / 10000, number / 100 % 100, number % 100, instruction_set(device)
    );
}

[[noreturn]] void refuse(RTCDevice device, const char* what) {
    throw Error(fmt::format(
        "Embree cannot {} (error {})", what, static_cast<int>(rtcGetDeviceError(device))
    ));
}

bool count_bytes(void* counter, ssize_t bytes, bool) {
    static_cast<std::atomic<std::ptrdiff_t>*>(counter)->fetch_add(bytes, std::memory_order_relaxed);
    return true;
}

} // namespace

bool has_embree() {
    return true;
}

std::string embree_version() {
    RTCDevice device = rtcNewDevice("threads=1");
    if (device == nullptr) refuse(nullptr, "make a device");
    std::string text = version_of(device);
    rtcReleaseDevice(device);
    return text;
}

EmbreePeer::EmbreePeer(const Scene& scene, const PeerParams& params)
    : state_(std::make_unique<State>()) {
    State& state = *state_;
    state.vertices = scene.vertices;
    state.vertices.emplace_back(); // Embree reads 16 bytes at the last vertex
    state.device = rtcNewDevice(fmt::format("threads={}", params.threads).c_str());
    if (state.device == nullptr) refuse(nullptr, "make a device");
    rtcSetDeviceMemoryMonitorFunction(state.device, count_bytes, &state.held);

    RTCGeometry mesh = rtcNewGeometry(state.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(
        mesh,
        RTC_BUFFER_TYPE_VERTEX,
        0,
        RTC_FORMAT_FLOAT3,
        state.vertices.data(),
        0,
        sizeof(Vec3),
        scene.vertices.size()
    );
    rtcSetSharedGeometryBuffer(
        mesh,
        RTC_BUFFER_TYPE_INDEX,
        0,
        RTC_FORMAT_UINT3,
        scene.triangles.data(),
        0,
        sizeof scene.triangles[0],
        scene.triangles.size()
    );
    const RTCBuildQuality quality =
        params.quality == PeerQuality::high ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
    rtcSetGeometryBuildQuality(mesh, quality);
    rtcCommitGeometry(mesh);
    state.scene = rtcNewScene(state.device);
    rtcSetSceneBuildQuality(state.scene, quality);
    if (params.is_robust) rtcSetSceneFlags(state.scene, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometryByID(state.scene, mesh, 0);
    rtcReleaseGeometry(mesh);

    const std::ptrdiff_t before = state.held.load();
    const Stopwatch watch;
    rtcCommitScene(state.scene);
    state.build_ms = watch.milliseconds();
    state.bytes = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, state.held.load() - before));
    if (rtcGetDeviceError(state.device) != RTC_ERROR_NONE) refuse(state.device, "build the scene");
}

EmbreePeer::~EmbreePeer() = default;
EmbreePeer::EmbreePeer(EmbreePeer&&) noexcept = default;
EmbreePeer& EmbreePeer::operator=(EmbreePeer&&) noexcept = default;

double EmbreePeer::build_ms() const {
    return state_->build_ms;
}

std::size_t EmbreePeer::bytes() const {
    return state_->bytes;
}

} // namespace raywise::app
