#include "embree.hpp"

#include <raywise/analysis/ray_order.hpp>

#include <fmt/format.h>

#include <span>
#include <string>
#include <vector>

namespace raywise::app {

std::string describe(const PeerCall& call, bool closest) {
    std::string text = fmt::format("rtc{}{}", closest ? "Intersect" : "Occluded", call.width);
    if (call.width > 1) text += call.is_coherent ? " coherent" : " incoherent";
    if (call.order) text += fmt::format(", sorted by {}", name_of(*call.order));
    return text;
}

std::vector<PeerCall> peer_calls(std::span<const RayOrder> orders) {
    constexpr PeerCall ways[] = {{1, false}, {8, true}, {8, false}, {16, true}, {16, false}};
    std::vector<PeerCall> calls;
    for (const PeerCall& way : ways)
        calls.push_back(way);
    for (const RayOrder order : orders)
        for (PeerCall way : ways) {
            way.order = order;
            calls.push_back(way);
        }
    return calls;
}

} // namespace raywise::app
