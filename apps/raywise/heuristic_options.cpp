#include "heuristic_options.hpp"

#include <raywise/toplevel/build_tree.hpp>

#include <map>
#include <string>

namespace raywise::app {

namespace {

const std::map<std::string, MeasureKind> measures = {
    {"sah", MeasureKind::surface},
    {"pah", MeasureKind::area},
    {"mixed", MeasureKind::mixed},
    {"measured", MeasureKind::counted},
};
const std::map<std::string, AxisChoice> axis_choices = {
    {"longest", AxisChoice::longest},
    {"facing", AxisChoice::facing},
    {"all", AxisChoice::all},
};
const std::map<std::string, BuilderKind> builders = {
    {"binned", BuilderKind::binned},
    {"sweep", BuilderKind::sweep},
    {"guided", BuilderKind::guided},
};

} // namespace

void add_heuristic_options(CLI::App& command, HeuristicOptions& options) {
    command
        .add_option(
            "--measure",
            options.measure,
            "How boxes are weighed: sah (surface area), pah (the area's rays), mixed (pah with a "
            "grain of sah), measured "
            "(the area's rays, counted)"
        )
        ->check(CLI::IsMember(&measures))
        ->capture_default_str();
    command
        .add_option("--axes", options.axes, "Split axes tried: longest, facing (the rays) or all")
        ->check(CLI::IsMember(&axis_choices))
        ->capture_default_str();
    command
        .add_option(
            "--builder", options.builder, "binned, sweep (every plane) or guided (the thesis's)"
        )
        ->check(CLI::IsMember(&builders))
        ->capture_default_str();
}

Heuristic heuristic_of(const HeuristicOptions& options) {
    Heuristic heuristic;
    heuristic.measure = measures.at(options.measure);
    heuristic.axes = axis_choices.at(options.axes);
    heuristic.builder = builders.at(options.builder);
    return heuristic;
}

} // namespace raywise::app
