// The program: finds the subcommand, reads its options, and turns every way to fail into one line
// and an exit code.
#include "config_file.hpp"
#include "console.hpp"
#include "exit_code.hpp"
#include "output.hpp"
#include "session.hpp"
#include "stop_signals.hpp"
#include "version.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/nearest_word.hpp>
#include <raywise/core/progress.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace raywise::app {

namespace {

/// The arguments as one line that a shell reads back.
std::string command_line(const std::vector<std::string>& arguments) {
    constexpr const char* harmless =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
    std::string line = "raywise";
    for (const std::string& argument : arguments) {
        line += ' ';
        if (!argument.empty() && argument.find_first_not_of(harmless) == std::string::npos) {
            line += argument;
            continue;
        }
        line += '\'';
        for (const char c : argument)
            line += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += '\'';
    }
    return line;
}

std::vector<std::string> names_of(const std::vector<Command>& commands) {
    std::vector<std::string> names;
    names.reserve(commands.size());
    for (const Command& command : commands)
        names.push_back(command.app->get_name());
    return names;
}

/// Throws UsageError for a first word that is no subcommand.
void require_subcommand(
    const std::vector<std::string>& arguments,
    const std::vector<Command>& commands
) {
    const std::vector<std::string> names = names_of(commands);
    if (arguments.empty()) throw UsageError("a subcommand is needed; see raywise --help");
    const std::string& word = arguments.front();
    if (word.starts_with("-") || std::find(names.begin(), names.end(), word) != names.end()) return;
    throw UsageError(
        "unknown subcommand '" + word + "'" + did_you_mean(word, names) + "; see raywise --help"
    );
}

/// What is wrong with an argument that no option takes.
std::string describe_extra(const CLI::App& root, const CLI::App* command) {
    const std::vector<std::string> extras = root.remaining(true);
    const std::string argument = extras.empty() ? std::string("?") : extras.front();
    if (!argument.starts_with("--")) return "unexpected argument '" + argument + "'";
    std::vector<std::string> known;
    for (const CLI::Option* option : (command != nullptr ? *command : root).get_options({}))
        for (const std::string& name : option->get_lnames())
            known.push_back("--" + name);
    const std::string name = argument.substr(0, argument.find('='));
    return "unknown option '" + name + "'" + did_you_mean(name, known);
}

const Command* chosen(const std::vector<Command>& commands) {
    for (const Command& command : commands)
        if (command.app->parsed()) return &command;
    return nullptr;
}

/// Reads the command line. Throws UsageError; true when a help or version text was asked for and
/// given.
bool parse(
    CLI::App& root,
    const std::vector<Command>& commands,
    std::vector<std::string> arguments
) {
    std::reverse(arguments.begin(), arguments.end()); // CLI11 takes them from the back
    const Command* command = nullptr;
    try {
        root.parse(std::move(arguments));
    } catch (const CLI::CallForVersion& asked) {
        put({}, std::string(asked.what()) + "\n");
        return true;
    } catch (const CLI::CallForHelp&) {
        command = chosen(commands);
        put({}, command != nullptr ? command->app->help("raywise") : root.help());
        return true;
    } catch (const CLI::ExtrasError&) {
        command = chosen(commands);
        throw UsageError(describe_extra(root, command != nullptr ? command->app : nullptr));
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    return false;
}

void run(const std::vector<std::string>& arguments, Console& console, const StopSignals& signals) {
    CLI::App root("Acceleration structures that know where the rays go.", "raywise");
    root.set_version_flag("--version", "raywise " + version());
    root.require_subcommand(1);
    root.option_defaults()->take_last();
    root.footer("Exit codes: 0 ok, 2 usage, 3 input refused, 4 resource limit, 5 input/output,\n"
                "6 an internal check failed, 130 and 143 stopped by a signal.");

    CommonOptions options;
    const std::vector<Command> commands = {
        add_info(root, options),
        add_build(root, options),
        add_trace(root, options),
        add_compare(root, options),
        add_bench(root, options),
        add_convert(root, options),
    };
    require_subcommand(arguments, commands);
    if (parse(root, commands, arguments)) return;

    const Command& command = *chosen(commands);
    if (!options.config.empty()) apply_config(*command.app, options.config);
    console.set_quiet(options.quiet);
    if (options.dump_config) {
        put(options.output, dump_config(*command.app));
        return;
    }
    for (const CLI::Option* option : command.required)
        if (option->count() == 0) throw UsageError(option->get_name() + " is needed");
    command.run({options, console, signals, command_line(arguments)});
}

ExitCode guarded_run(
    const std::vector<std::string>& arguments,
    Console& console,
    const StopSignals& signals
) {
    try {
        run(arguments, console, signals);
        return ExitCode::ok;
    } catch (const UsageError& error) {
        console.error(error.what());
        return ExitCode::usage;
    } catch (const Error& error) {
        console.error(error.what());
        return exit_code(error.kind());
    } catch (const Cancelled&) {
        console.error(stopped_message);
        return ExitCode::signal;
    } catch (const CheckFailed& error) {
        console.error(error.what());
        return ExitCode::check_failed;
    } catch (const std::bad_alloc&) {
        console.error("out of memory");
        return ExitCode::limit;
    } catch (const std::length_error&) {
        console.error("out of memory: a size is beyond what can be addressed");
        return ExitCode::limit;
    } catch (const std::exception& error) {
        console.error(std::string("internal error: ") + error.what());
        return ExitCode::check_failed;
    }
}

} // namespace

} // namespace raywise::app

int main(int argc, char** argv) {
    using namespace raywise::app;
    Console console;
    const StopSignals signals(console);
    const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    const ExitCode code = guarded_run(arguments, console, signals);
    return static_cast<int>(code) + (code == ExitCode::signal ? signals.received() : 0);
}
