#include "console.hpp"
#include "output.hpp"
#include "session.hpp"
#include "version.hpp"

#include <raywise/core/function_ref.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/io/report.hpp>

#include <cstdint>
#include <limits>
#include <string_view>

namespace raywise::app {

Progress Session::progress() const {
    Console& target = console;
    return {
        [&target](std::string_view stage, std::uint64_t done, std::uint64_t total) {
            target.progress(stage, done, total);
        },
        signals.token()
    };
}

Provenance Session::provenance() const {
    Provenance result = machine_provenance();
    result.version = version();
    result.threads = executor().threads();
    result.seed = static_cast<std::uint64_t>(options.seed);
    result.command = command_line;
    return result;
}

void Session::put_files(FunctionRef<void()> write) const {
    const auto lock = signals.hold();
    write();
}

void Session::put_report(const Report& report, const std::string& path) const {
    put_files([&] { put(path, to_string(report, report_format(options.format))); });
}

void add_common_options(CLI::App& command, CommonOptions& options, const std::string& output_help) {
    command.add_option("--format", options.format, "How the report is written: table, csv or json")
        ->check(CLI::IsMember({"table", "csv", "json"}))
        ->capture_default_str();
    command.add_option("-o,--output", options.output, output_help);
    command.add_option("--seed", options.seed, "Seed of everything random")
        ->check(CLI::Range(std::int64_t{0}, std::numeric_limits<std::int64_t>::max()))
        ->capture_default_str();
    command.add_option("--threads", options.threads, "Threads; 0: all of the machine")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    command.add_flag("--quiet", options.quiet, "Errors only on standard error");
    command
        .add_option(
            "--config", options.config, "JSON file with values for the options left out here"
        )
        ->configurable(false);
    command
        .add_flag("--dump-config", options.dump_config, "Print all options as such a file, and end")
        ->configurable(false);
}

} // namespace raywise::app
