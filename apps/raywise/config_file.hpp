// Options of a subcommand in a JSON file: one flat object, its keys the long option names.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace raywise::app {

/// Gives every option that the command line left out the value in the file. The key "command", if
/// there, must be the subcommand's name. Throws Error for text that is not JSON (with the byte), an
/// unknown key (with the nearest known one), a repeated key, and a value that its option refuses.
void apply_config(CLI::App& command, const std::string& path);

/// All options of the subcommand with their values in effect, as `apply_config` reads them.
[[nodiscard]] std::string dump_config(const CLI::App& command);

} // namespace raywise::app
