#include "embree_state.hpp"
#include "flushed_denormals.hpp"
#include "peer/embree.hpp"

#include <raywise/analysis/ray_order.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

namespace raywise::app {

namespace {

template <int width>
struct PacketTypes;

template <>
struct PacketTypes<8> {
    using Shadow = RTCRay8;
    using Closest = RTCRayHit8;
};

template <>
struct PacketTypes<16> {
    using Shadow = RTCRay16;
    using Closest = RTCRayHit16;
};

void trace(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay8* rays) {
    rtcOccluded8(valid, scene, context, rays);
}

void trace(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay16* rays) {
    rtcOccluded16(valid, scene, context, rays);
}

void trace(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8* rays) {
    rtcIntersect8(valid, scene, context, rays);
}

void trace(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit16* rays) {
    rtcIntersect16(valid, scene, context, rays);
}

RTCRay to_rtc(const Ray& ray) {
    RTCRay result{};
    result.org_x = ray.origin.x;
    result.org_y = ray.origin.y;
    result.org_z = ray.origin.z;
    result.tnear = ray.t_min;
    result.dir_x = ray.direction.x;
    result.dir_y = ray.direction.y;
    result.dir_z = ray.direction.z;
    result.tfar = ray.t_max;
    result.mask = std::numeric_limits<unsigned>::max();
    return result;
}

template <class Packet>
void put(Packet& packet, std::size_t lane, const RTCRay& ray) {
    packet.org_x[lane] = ray.org_x;
    packet.org_y[lane] = ray.org_y;
    packet.org_z[lane] = ray.org_z;
    packet.tnear[lane] = ray.tnear;
    packet.dir_x[lane] = ray.dir_x;
    packet.dir_y[lane] = ray.dir_y;
    packet.dir_z[lane] = ray.dir_z;
    packet.time[lane] = 0;
    packet.tfar[lane] = ray.tfar;
    packet.mask[lane] = ray.mask;
    packet.id[lane] = 0;
    packet.flags[lane] = 0;
}

Hit to_hit(float t, unsigned prim) {
    Hit hit;
    if (prim == RTC_INVALID_GEOMETRY_ID) return hit;
    hit.t = t;
    hit.prim = to_prim(prim);
    return hit;
}

RTCIntersectContext context_of(const PeerCall& call) {
    RTCIntersectContext context{};
    rtcInitIntersectContext(&context);
    context.flags = call.is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                     : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

} // namespace

struct PeerRays::Layouts {
    std::span<const Ray> given;
    std::vector<RTCRay> single;
    std::vector<RTCRay8> packets_of_8;
    std::vector<RTCRay16> packets_of_16;
};

namespace {

template <class Packet, std::size_t width>
std::vector<Packet> pack(std::span<const RTCRay> rays) {
    std::vector<Packet> packets((rays.size() + width - 1) / width);
    for (std::size_t i = 0; i < rays.size(); ++i)
        put(packets[i / width], i % width, rays[i]);
    return packets;
}

/// One call for each ray; `place(i)` is the ray to trace as number i.
template <class Answer, class Place>
void trace_singly(
    RTCScene scene,
    const PeerCall& call,
    std::span<const RTCRay> rays,
    std::size_t count,
    const Place& place,
    std::span<Answer> answers
) {
    RTCIntersectContext context = context_of(call);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = place(i);
        if constexpr (std::is_same_v<Answer, bool>) {
            RTCRay ray = rays[at];
            rtcOccluded1(scene, &context, &ray);
            answers[at] = ray.tfar < 0;
        } else {
            RTCRayHit query; // NOLINT(*-member-init): what is read is written
            query.ray = rays[at];
            query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            query.hit.primID = RTC_INVALID_GEOMETRY_ID;
            query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene, &context, &query);
            answers[at] = to_hit(query.ray.tfar, query.hit.primID);
        }
    }
}

template <int width, class Packet, class Answer, class Place>
void trace_packet(
    RTCScene scene,
    RTCIntersectContext& context,
    const Packet& rays,
    std::size_t count,
    const Place& place,
    std::span<Answer> answers
) {
    constexpr std::size_t lanes = width;
    alignas(64) int valid[lanes];
    for (std::size_t lane = 0; lane < lanes; ++lane)
        valid[lane] = lane < count ? -1 : 0;
    if constexpr (std::is_same_v<Answer, bool>) {
        Packet query = rays;
        trace(valid, scene, &context, &query);
        for (std::size_t lane = 0; lane < count; ++lane)
            answers[place(lane)] = query.tfar[lane] < 0;
    } else {
        typename PacketTypes<width>::Closest query;
        query.ray = rays;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            query.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
            query.hit.primID[lane] = RTC_INVALID_GEOMETRY_ID;
            query.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        }
        trace(valid, scene, &context, &query);
        for (std::size_t lane = 0; lane < count; ++lane)
            answers[place(lane)] = to_hit(query.ray.tfar[lane], query.hit.primID[lane]);
    }
}

/// Packets `first`, ... of the rays as given.
template <int width, class Packet, class Answer>
void trace_packets(
    RTCScene scene,
    const PeerCall& call,
    std::span<const Packet> packets,
    std::size_t first,
    std::span<Answer> answers
) {
    RTCIntersectContext context = context_of(call);
    for (std::size_t p = 0; p < packets.size(); ++p) {
        const std::size_t begin = (first + p) * width;
        trace_packet<width>(
            scene,
            context,
            packets[p],
            std::min<std::size_t>(width, answers.size() - begin),
            [&](std::size_t lane) { return begin + lane; },
            answers
        );
    }
}

/// Packets of the rays rays[places[0]], rays[places[1]], ...
template <int width, class Answer>
void trace_gathered(
    RTCScene scene,
    const PeerCall& call,
    std::span<const RTCRay> rays,
    std::span<const std::uint32_t> places,
    std::span<Answer> answers
) {
    using Packet = typename PacketTypes<width>::Shadow;
    RTCIntersectContext context = context_of(call);
    for (std::size_t i = 0; i < places.size(); i += width) {
        const std::size_t count = std::min<std::size_t>(width, places.size() - i);
        Packet packet{};
        for (std::size_t lane = 0; lane < count; ++lane)
            put(packet, lane, rays[places[i + lane]]);
        trace_packet<width>(
            scene,
            context,
            packet,
            count,
            [&](std::size_t lane) { return places[i + lane]; },
            answers
        );
    }
}

/// Each thread sorts and traces a share of its own.
template <class Answer>
void trace_sorted(
    RTCScene scene,
    const PeerCall& call,
    std::span<const Ray> given,
    std::span<const RTCRay> rays,
    std::span<Answer> answers,
    const Executor& executor
) {
    const auto threads = static_cast<std::size_t>(executor.threads());
    const std::size_t share = std::max<std::size_t>(1, (rays.size() + threads - 1) / threads);
    executor.for_each_chunk(rays.size(), share, [&](std::size_t begin, std::size_t end) {
        const FlushedDenormals flushed;
        const std::size_t count = end - begin;
        const std::vector<std::uint32_t> places =
            sorted_places(given.subspan(begin, count), *call.order);
        const auto own_rays = rays.subspan(begin, count);
        const auto own_answers = answers.subspan(begin, count);
        if (call.width == 8)
            trace_gathered<8>(scene, call, own_rays, places, own_answers);
        else if (call.width == 16)
            trace_gathered<16>(scene, call, own_rays, places, own_answers);
        else
            trace_singly(
                scene,
                call,
                own_rays,
                count,
                [&](std::size_t i) { return std::size_t{places[i]}; },
                own_answers
            );
    });
}

constexpr std::size_t rays_per_chunk = 4096;

template <int width, class Packet, class Answer>
void trace_given_packets(
    RTCScene scene,
    const PeerCall& call,
    const std::vector<Packet>& packets,
    std::span<Answer> answers,
    const Executor& executor
) {
    executor.for_each_chunk(
        packets.size(),
        rays_per_chunk / width,
        [&](std::size_t begin, std::size_t end) {
            const FlushedDenormals flushed;
            trace_packets<width>(
                scene, call, std::span(packets).subspan(begin, end - begin), begin, answers
            );
        }
    );
}

template <class Layouts, class Answer>
void trace_all(
    RTCScene scene,
    const PeerCall& call,
    const Layouts& layouts,
    std::span<Answer> answers,
    const Executor& executor
) {
    const std::span<const RTCRay> rays(layouts.single);
    if (rays.size() != answers.size()) throw Error("as many answers as rays are needed");
    if (call.order) {
        trace_sorted(scene, call, layouts.given, rays, answers, executor);
    } else if (call.width == 8) {
        trace_given_packets<8>(scene, call, layouts.packets_of_8, answers, executor);
    } else if (call.width == 16) {
        trace_given_packets<16>(scene, call, layouts.packets_of_16, answers, executor);
    } else {
        executor
            .for_each_chunk(rays.size(), rays_per_chunk, [&](std::size_t begin, std::size_t end) {
                const FlushedDenormals flushed;
                trace_singly(
                    scene,
                    call,
                    rays.subspan(begin, end - begin),
                    end - begin,
                    [](std::size_t i) { return i; },
                    answers.subspan(begin, end - begin)
                );
            });
    }
}

} // namespace

PeerRays::PeerRays(std::span<const Ray> rays) : layouts_(std::make_unique<Layouts>()) {
    layouts_->given = rays;
    layouts_->single.reserve(rays.size());
    for (const Ray& ray : rays)
        layouts_->single.push_back(to_rtc(ray));
    layouts_->packets_of_8 = pack<RTCRay8, 8>(layouts_->single);
    layouts_->packets_of_16 = pack<RTCRay16, 16>(layouts_->single);
}

PeerRays::~PeerRays() = default;
PeerRays::PeerRays(PeerRays&&) noexcept = default;
PeerRays& PeerRays::operator=(PeerRays&&) noexcept = default;

void PeerRays::occluded(
    const EmbreePeer& peer,
    const PeerCall& call,
    std::span<bool> occluded,
    const Executor& executor
) const {
    trace_all(peer.state_->scene, call, *layouts_, occluded, executor);
}

void PeerRays::closest(
    const EmbreePeer& peer,
    const PeerCall& call,
    std::span<Hit> hits,
    const Executor& executor
) const {
    trace_all(peer.state_->scene, call, *layouts_, hits, executor);
}

} // namespace raywise::app
