// Reads JSON strictly: no repeated keys, no value of another type than asked for.
// Every refusal names the file and the value's place in it, such as areas[2].region.
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace raywise::io_detail {

/// The most deeply nested value that is read.
inline constexpr int max_json_depth = 64;

/// The document in `text`. Throws Error, with the line, for what is not JSON, is nested more deeply
/// than `max_json_depth`, or repeats a key in an object.
[[nodiscard]] nlohmann::json parse_json(std::string_view text, const std::filesystem::path& path);

/// Commas, colons and brackets in the text: what its document takes memory by.
[[nodiscard]] std::uint64_t count_json_tokens(std::string_view text);

/// A value of a document, and how it was reached. Refers to the document and the path.
class JsonValue {
public:
    JsonValue(const nlohmann::json& value, const std::filesystem::path& path)
        : value_(&value), path_(&path) {}

    [[noreturn]] void refuse(std::string_view reason) const;

    [[nodiscard]] const std::string& where() const { return where_; }

    [[nodiscard]] bool is_object() const { return value_->is_object(); }

    [[nodiscard]] bool is_array() const { return value_->is_array(); }

    /// The member; nullopt when there is none. Refuses unless this is an object.
    [[nodiscard]] std::optional<JsonValue> find(std::string_view key) const;

    /// The member; refuses when there is none.
    [[nodiscard]] JsonValue at(std::string_view key) const;

    /// Refuses unless this is an array.
    [[nodiscard]] std::size_t size() const;

    /// index < size().
    [[nodiscard]] JsonValue operator[](std::size_t index) const;

    /// A finite number.
    [[nodiscard]] double number() const;

    /// An integer in [0, most].
    [[nodiscard]] std::uint64_t integer(std::uint64_t most) const;

    [[nodiscard]] bool boolean() const;

    [[nodiscard]] const std::string& string() const;

private:
    JsonValue(const nlohmann::json& value, const std::filesystem::path& path, std::string where)
        : value_(&value), path_(&path), where_(std::move(where)) {}

    const nlohmann::json* value_;
    const std::filesystem::path* path_;
    std::string where_;
};

} // namespace raywise::io_detail
