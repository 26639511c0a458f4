// What every subcommand works with: the common options, where to say things, when to stop.
#pragma once

#include "console.hpp"
#include "stop_signals.hpp"

#include <raywise/core/executor.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/io/report.hpp>

#include <CLI/CLI.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace raywise::app {

/// The options that all subcommands share.
struct CommonOptions {
    std::string format = "table"; ///< of the report: table, csv or json
    std::string output;           ///< file for the data; empty: standard output
    std::int64_t seed = 1;        ///< of everything random; >= 0
    int threads = 0;              ///< 0: all hardware threads
    bool quiet = false;
    std::string config;
    bool dump_config = false;
};

/// One run of one subcommand.
struct Session {
    CommonOptions options;
    Console& console;
    const StopSignals& signals;
    std::string command_line; ///< quoted for a shell

    [[nodiscard]] Executor executor() const { return Executor(options.threads); }

    /// Shows steps on the console and stops at a signal.
    [[nodiscard]] Progress progress() const;

    /// Version, compiler, processor, threads, seed and command; the scene is the caller's.
    [[nodiscard]] Provenance provenance() const;

    /// Calls `write`, which writes files; a signal waits until it is done. Throws Cancelled when a
    /// stop was requested before.
    void put_files(FunctionRef<void()> write) const;

    /// Writes the report in the chosen format to `path`, or to standard output if that is empty.
    void put_report(const Report& report, const std::string& path) const;
};

/// A subcommand: its options on the command line, and what it does once they are read.
struct Command {
    CLI::App* app = nullptr;
    std::vector<CLI::Option*> required; ///< on the command line or in the configuration file
    std::function<void(const Session&)> run;
};

/// Adds the common options, with `-o` described as `output_help`.
void add_common_options(CLI::App& command, CommonOptions& options, const std::string& output_help);

// One function per subcommand, each in its own file.
[[nodiscard]] Command add_info(CLI::App& root, CommonOptions& options);
[[nodiscard]] Command add_build(CLI::App& root, CommonOptions& options);
[[nodiscard]] Command add_trace(CLI::App& root, CommonOptions& options);
[[nodiscard]] Command add_compare(CLI::App& root, CommonOptions& options);
[[nodiscard]] Command add_bench(CLI::App& root, CommonOptions& options);
[[nodiscard]] Command add_convert(CLI::App& root, CommonOptions& options);

} // namespace raywise::app
