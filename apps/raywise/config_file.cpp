#include "config_file.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/nearest_word.hpp>
#include <raywise/io/files.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

namespace raywise::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t size_limit = 1 << 20;

bool is_flag(const CLI::Option& option) {
    return option.get_items_expected_max() == 0;
}

/// The options that a file may set.
std::vector<CLI::Option*> configurable_options(const CLI::App& command) {
    std::vector<CLI::Option*> options;
    // CLI11 hands out pointers to options that may change only through a non-const app.
    for (CLI::Option* option : const_cast<CLI::App&>(command).get_options())
        if (option->get_configurable() && !option->get_lnames().empty()) options.push_back(option);
    return options;
}

Json parse(const std::string& path) {
    std::set<std::string> keys;
    const auto refuse_repeated_keys = [&](int, Json::parse_event_t event, Json& value) {
        if (event == Json::parse_event_t::key && !keys.insert(value.get<std::string>()).second)
            throw Error(path, nowhere(), "key '" + value.get<std::string>() + "' stands twice");
        return true;
    };
    const std::string text = read_file(path, size_limit);
    try {
        Json document = Json::parse(text, refuse_repeated_keys);
        if (!document.is_object()) throw Error(path, nowhere(), "is not a JSON object");
        return document;
    } catch (const Json::parse_error& error) {
        throw Error(path, at_byte(error.byte), "is not valid JSON");
    }
}

/// The value as the text that the command line would have held.
std::string argument(const std::string& path, const std::string& key, const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_boolean() || value.is_number()) return value.dump();
    throw Error(path, nowhere(), "key '" + key + "' is not a text, a number, true or false");
}

/// A number where the text is one in JSON's own spelling, so that reading it back gives the same
/// text.
Json value_of(const std::string& text) {
    const Json number = Json::parse(text, nullptr, false);
    return number.is_number() && number.dump() == text ? number : Json(text);
}

} // namespace

void apply_config(CLI::App& command, const std::string& path) {
    const std::vector<CLI::Option*> options = configurable_options(command);
    std::vector<std::string> known = {"command"};
    for (const CLI::Option* option : options)
        known.push_back(option->get_lnames()[0]);

    const Json document = parse(path);
    for (const auto& [key, value] : document.items()) {
        if (key == "command") {
            if (value != command.get_name())
                throw Error(
                    path,
                    nowhere(),
                    "is for the subcommand " + value.dump() + ", not '" + command.get_name() + "'"
                );
            continue;
        }
        const auto at = std::find(known.begin(), known.end(), key);
        if (at == known.end())
            throw Error(path, nowhere(), "unknown key '" + key + "'" + did_you_mean(key, known));
        CLI::Option& option = *options[static_cast<std::size_t>(at - known.begin()) - 1];
        if (option.count() > 0) continue; // the command line goes before the file
        const std::string text = argument(path, key, value);
        if (is_flag(option) && text == "false") continue;
        try {
            option.add_result(text);
            option.run_callback();
        } catch (const CLI::ParseError& error) {
            throw Error(path, nowhere(), "key '" + key + "': " + error.what());
        }
    }
}

std::string dump_config(const CLI::App& command) {
    Json document = Json::object();
    document["command"] = command.get_name();
    for (const CLI::Option* option : configurable_options(command)) {
        const std::string& key = option->get_lnames()[0];
        if (is_flag(*option))
            document[key] = option->count() > 0;
        else if (option->count() > 0)
            document[key] = value_of(option->results().back());
        else if (!option->get_default_str().empty())
            document[key] = value_of(option->get_default_str());
    }
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace raywise::app
