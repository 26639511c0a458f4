// Names of heuristics on the command line.
#pragma once

#include <raywise/toplevel/build_tree.hpp>

#include <CLI/CLI.hpp>

#include <string>

namespace raywise::app {

struct HeuristicOptions {
    std::string measure = "sah"; ///< sah, pah, mixed or measured
    std::string axes = "all";    ///< longest, facing or all
    std::string builder = "binned";
};

/// Adds --measure, --axes and --builder.
void add_heuristic_options(CLI::App& command, HeuristicOptions& options);

/// What the names stand for.
[[nodiscard]] Heuristic heuristic_of(const HeuristicOptions& options);

} // namespace raywise::app
