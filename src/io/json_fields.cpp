#include "io/json_fields.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/nearest_word.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raywise::detail {

namespace {

double number_of(const JsonFields& fields, const std::string& key, const Json& value) {
    if (!value.is_number()) fields.refuse("'" + key + "' is not a number");
    return value.get<double>();
}

std::string text_of(const JsonFields& fields, const std::string& key, const Json& value) {
    if (!value.is_string()) fields.refuse("'" + key + "' is not a text");
    return value.get<std::string>();
}

} // namespace

JsonFields::JsonFields(const Json& json, std::string path, std::string context)
    : json_(json), path_(std::move(path)), context_(std::move(context)) {
    if (!json_.is_object()) refuse("is not a JSON object");
}

const Json* JsonFields::optional(const std::string& key) {
    asked_.push_back(key);
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
}

const Json& JsonFields::required(const std::string& key) {
    const Json* value = optional(key);
    if (value == nullptr) {
        // A slip in the name of a required key shows up as that key missing: say both.
        std::vector<std::string> present;
        for (const auto& [name, other] : json_.items())
            present.push_back(name);
        const auto slip = nearest_word(key, present);
        refuse("'" + key + "' is missing" + (slip ? "; is '" + *slip + "' meant for it?" : ""));
    }
    return *value;
}

double JsonFields::number(const std::string& key) {
    return number_of(*this, key, required(key));
}

std::string JsonFields::text(const std::string& key) {
    return text_of(*this, key, required(key));
}

Vec3d JsonFields::vector(const std::string& key) {
    const Json& value = required(key);
    const bool is_vector =
        value.is_array() && value.size() == 3 &&
        std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_number(); });
    if (!is_vector) refuse("'" + key + "' is not a list of three numbers");
    return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

double JsonFields::number_or(const std::string& key, double fallback) {
    const Json* value = optional(key);
    return value != nullptr ? number_of(*this, key, *value) : fallback;
}

std::string JsonFields::text_or(const std::string& key, const std::string& fallback) {
    const Json* value = optional(key);
    return value != nullptr ? text_of(*this, key, *value) : fallback;
}

void JsonFields::refuse_others() const {
    for (const auto& [key, value] : json_.items())
        if (std::find(asked_.begin(), asked_.end(), key) == asked_.end())
            refuse("unknown key '" + key + "'" + did_you_mean(key, asked_));
}

void JsonFields::refuse(std::string_view reason) const {
    throw Error(
        path_,
        nowhere(),
        context_.empty() ? std::string(reason) : context_ + ": " + std::string(reason)
    );
}

} // namespace raywise::detail
