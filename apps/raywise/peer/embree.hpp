// Embree beside us: the same triangles, the same rays, its best settings. In bench and tests only.
#pragma once

#include <raywise/analysis/ray_order.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raywise::app {

/// Whether this program was built with Embree. Without it the constructors below throw Error.
[[nodiscard]] bool has_embree();

/// "3.13.5, AVX2"; empty without Embree.
[[nodiscard]] std::string embree_version();

enum class PeerQuality : std::uint8_t { medium, high };

struct PeerParams {
    PeerQuality quality = PeerQuality::high;
    bool is_robust = false; ///< RTC_SCENE_FLAG_ROBUST: watertight, no spatial splits
    int threads = 1;        ///< of the build
};

/// A scene that Embree has built. Queries are const and thread-safe.
class EmbreePeer {
public:
    /// Copies the vertices (for the padding that Embree asks for); `scene` must outlive the peer.
    EmbreePeer(const Scene& scene, const PeerParams& params);
    ~EmbreePeer();
    EmbreePeer(EmbreePeer&&) noexcept;
    EmbreePeer& operator=(EmbreePeer&&) noexcept;
    EmbreePeer(const EmbreePeer&) = delete;
    EmbreePeer& operator=(const EmbreePeer&) = delete;

    [[nodiscard]] double build_ms() const;

    /// What Embree's memory monitor holds for the committed scene, the mesh left out.
    [[nodiscard]] std::size_t bytes() const;

private:
    friend class PeerRays;
    struct State;
    std::unique_ptr<State> state_;
};

/// How rays are handed over.
struct PeerCall {
    int width = 1; ///< 1: one ray per call; 8 or 16: packets
    bool is_coherent = false;
    std::optional<RayOrder> order = {}; ///< sorted so first; the sorting is part of the call
};

/// "rtcOccluded8 coherent, sorted by direction".
[[nodiscard]] std::string describe(const PeerCall& call, bool closest);

/// Every call worth trying for rays that may be sorted in these orders; the first is one ray per
/// call as given.
[[nodiscard]] std::vector<PeerCall> peer_calls(std::span<const RayOrder> orders);

/// Rays in Embree's own layouts, made once so that no conversion is timed.
class PeerRays {
public:
    explicit PeerRays(std::span<const Ray> rays);
    ~PeerRays();
    PeerRays(PeerRays&&) noexcept;
    PeerRays& operator=(PeerRays&&) noexcept;
    PeerRays(const PeerRays&) = delete;
    PeerRays& operator=(const PeerRays&) = delete;

    /// occluded[i] tells whether ray i has a hit. Sizes must agree.
    void occluded(
        const EmbreePeer& peer,
        const PeerCall& call,
        std::span<bool> occluded,
        const Executor& executor
    ) const;

    /// t and prim of the closest hits; a miss is t = +inf, no_prim. Sizes must agree.
    void closest(
        const EmbreePeer& peer,
        const PeerCall& call,
        std::span<Hit> hits,
        const Executor& executor
    ) const;

private:
    struct Layouts;
    std::unique_ptr<Layouts> layouts_;
};

} // namespace raywise::app
