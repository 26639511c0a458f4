// Strict reading of JSON objects: every key is asked for, or it is an error.
#pragma once

#include <raywise/geometry/vec.hpp>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raywise::detail {

using Json = nlohmann::json;

/// One object of a file. `context` names it in errors: "area 'sun'". Ask for every key that it may
/// have, then call `refuse_others`.
class JsonFields {
public:
    /// Throws Error if `json` is not an object.
    JsonFields(const Json& json, std::string path, std::string context);

    /// Throw Error when the key is missing or its value has another type. Numbers are finite by the
    /// rules of JSON.
    [[nodiscard]] const Json& required(const std::string& key);
    [[nodiscard]] double number(const std::string& key);
    [[nodiscard]] std::string text(const std::string& key);
    [[nodiscard]] Vec3d vector(const std::string& key);

    /// Null when the key is missing.
    [[nodiscard]] const Json* optional(const std::string& key);
    [[nodiscard]] double number_or(const std::string& key, double fallback);
    [[nodiscard]] std::string text_or(const std::string& key, const std::string& fallback);

    /// Throws Error for a key that was never asked for, with the nearest one that was.
    void refuse_others() const;

    /// Throws Error: file, context, reason.
    [[noreturn]] void refuse(std::string_view reason) const;

    [[nodiscard]] const std::string& path() const { return path_; }

    [[nodiscard]] const std::string& context() const { return context_; }

private:
    const Json& json_;
    std::string path_;
    std::string context_;
    std::vector<std::string> asked_;
};

} // namespace raywise::detail
