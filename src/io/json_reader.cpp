#include "json_reader.hpp"

#include <raywise/core/error.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raywise::io_detail {

namespace {

using nlohmann::json;

/// The line of the text that holds the byte.
std::uint64_t line_of(std::string_view text, std::size_t byte) {
    const std::string_view before = text.substr(0, byte);
    return 1 + static_cast<std::uint64_t>(std::count(before.begin(), before.end(), '\n'));
}

/// Builds the document as the library's own handler does, and refuses repeated keys on the way:
/// the library would keep the last one in silence.
class DocumentBuilder : public nlohmann::detail::json_sax_dom_parser<json> {
    using Base = nlohmann::detail::json_sax_dom_parser<json>;

public:
    explicit DocumentBuilder(json& document) : Base(document, false) {}

    bool start_object(std::size_t count) {
        keys_.emplace_back();
        return Base::start_object(count);
    }

    bool key(std::string& name) {
        if (!keys_.back().insert(name).second) {
            repeated_ = name;
            return false;
        }
        return Base::key(name);
    }

    bool end_object() {
        keys_.pop_back();
        return Base::end_object();
    }

    bool parse_error(std::size_t position, const std::string&, const json::exception& error) {
        position_ = position;
        reason_ = error.what();
        return false;
    }

    [[nodiscard]] std::size_t position() const { return position_; }

    /// Why the parser stopped.
    [[nodiscard]] std::string reason() const {
        if (repeated_) return fmt::format("key '{}' is repeated", escaped(*repeated_, 60));
        // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
        const std::size_t colon = reason_.find(": ");
        return "not JSON: " + (colon == std::string::npos ? reason_ : reason_.substr(colon + 2));
    }

private:
    std::vector<std::set<std::string>> keys_;
    std::optional<std::string> repeated_;
    std::size_t position_ = 0;
    std::string reason_;
};

/// Refuses texts that are nested too deeply before a parser meets them.
void check_depth(std::string_view text, const std::filesystem::path& path) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > max_json_depth)
                throw Error(
                    path.string(),
                    at_line(line_of(text, i)),
                    fmt::format("nested more than {} deep", max_json_depth)
                );
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
}

} // namespace

json parse_json(std::string_view text, const std::filesystem::path& path) {
    check_depth(text, path);
    json document;
    DocumentBuilder builder(document);
    bool is_parsed = false;
    try {
        is_parsed = json::sax_parse(text.begin(), text.end(), &builder);
    } catch (const json::exception& error) { // a handler's own refusals, such as of sizes
        throw Error(path.string(), nowhere(), error.what());
    }
    if (!is_parsed) {
        const std::size_t at = std::min(builder.position(), text.size());
        const Place place = at == 0 ? nowhere() : at_line(line_of(text, at));
        throw Error(path.string(), place, builder.reason());
    }
    return document;
}

std::uint64_t count_json_tokens(std::string_view text) {
    constexpr std::string_view marks = ",:[]{}";
    return static_cast<std::uint64_t>(std::count_if(text.begin(), text.end(), [&](char c) {
        return marks.find(c) != std::string_view::npos;
    }));
}

void JsonValue::refuse(std::string_view reason) const {
    throw Error(
        path_->string(),
        nowhere(),
        where_.empty() ? std::string(reason) : fmt::format("{}: {}", escaped(where_, 100), reason)
    );
}

std::optional<JsonValue> JsonValue::find(std::string_view key) const {
    if (!value_->is_object()) refuse("must be an object");
    const auto member = value_->find(key);
    if (member == value_->end()) return std::nullopt;
    return JsonValue(
        *member, *path_, where_.empty() ? std::string(key) : fmt::format("{}.{}", where_, key)
    );
}

JsonValue JsonValue::at(std::string_view key) const {
    auto member = find(key);
    if (!member) refuse(fmt::format("needs a key '{}'", key));
    return *std::move(member);
}

std::size_t JsonValue::size() const {
    if (!value_->is_array()) refuse("must be an array");
    return value_->size();
}

JsonValue JsonValue::operator[](std::size_t index) const {
    return {(*value_)[index], *path_, fmt::format("{}[{}]", where_, index)};
}

double JsonValue::number() const {
    if (!value_->is_number()) refuse("must be a number");
    const double number = value_->get<double>();
    if (!std::isfinite(number)) refuse("must be finite");
    return number;
}

std::uint64_t JsonValue::integer(std::uint64_t most) const {
    if (!value_->is_number_unsigned()) refuse("must be an integer that is not negative");
    const auto number = value_->get<std::uint64_t>();
    if (number > most) refuse(fmt::format("is {}, but must be at most {}", number, most));
    return number;
}

bool JsonValue::boolean() const {
    if (!value_->is_boolean()) refuse("must be true or false");
    return value_->get<bool>();
}

const std::string& JsonValue::string() const {
    if (!value_->is_string()) refuse("must be a string");
    return value_->get_ref<const std::string&>();
}

} // namespace raywise::io_detail
