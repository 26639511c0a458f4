#include <raywise/toplevel/structure_choice.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace raywise {
namespace {

/// Three digits and a unit; the formatting library is kept out of this layer.
std::string with_unit(double nanoseconds) {
    struct Unit {
        double scale;
        const char* name;
    };

    constexpr std::array units{Unit{1e9, "s"}, Unit{1e6, "ms"}, Unit{1e3, "us"}, Unit{1, "ns"}};
    const auto* unit = std::find_if(units.begin(), units.end() - 1, [&](const Unit& candidate) {
        return nanoseconds >= candidate.scale;
    });
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), "%.3g %s", nanoseconds / unit->scale, unit->name);
    return text.data();
}

std::string rounded(double value) {
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return text.data();
}

} // namespace

std::string_view name_of(StructureKind kind) {
    switch (kind) {
    case StructureKind::none:
        return "none";
    case StructureKind::binary_tree:
        return "binary_tree";
    case StructureKind::wide_tree:
        return "wide_tree";
    case StructureKind::framed_tree:
        return "framed_tree";
    case StructureKind::pencil_grid:
        return "pencil_grid";
    case StructureKind::inversion:
        break;
    }
    return "inversion";
}

StructurePrediction cheapest(const std::vector<StructurePrediction>& predictions, double rays) {
    return *std::min_element(
        predictions.begin(),
        predictions.end(),
        [&](const StructurePrediction& a, const StructurePrediction& b) {
            return a.total_ns(rays) < b.total_ns(rays);
        }
    );
}

std::string explain(const StructureChoice& choice) {
    std::string text = std::string(name_of(choice.kind)) +
                       (choice.is_forced ? ", forced" : ", cheapest") + " for " +
                       rounded(choice.expected_rays) + " rays";
    for (const StructurePrediction& candidate : choice.predictions) {
        text += "\n  " + std::string(name_of(candidate.kind)) + ": build " +
                with_unit(candidate.build_ns) + ", " + with_unit(candidate.ray_ns) +
                " per ray, total " + with_unit(candidate.total_ns(choice.expected_rays));
        const double saved = choice.predictions.front().ray_ns - candidate.ray_ns;
        if (candidate.build_ns > 0 && saved > 0)
            text += ", pays from " + rounded(candidate.build_ns / saved) + " rays";
    }
    if (!choice.remark.empty()) text += "\n  " + choice.remark;
    return text;
}

} // namespace raywise
