// raywise_verify [--rays N] [--seed S] [--threads T] [--check NAME]...: runs the long checks,
// prints "name: N rays, W wrong" for each, exits 1 when anything is wrong and 2 when misused.
#include "verify/checks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string_view>
#include <vector>

namespace {

using raywise::verify::Options;
using raywise::verify::Outcome;

struct Check {
    std::string_view name;
    Outcome (*run)(const Options&);
};

constexpr std::array checks{
    Check{"hits", raywise::verify::check_hits},
    Check{"leaks", raywise::verify::check_leaks},
    Check{"slabs", raywise::verify::check_slabs},
    Check{"areas", raywise::verify::check_areas},
};

struct Request {
    Options options;
    std::vector<std::string_view> names; ///< none: all checks
};

bool is_check(std::string_view name) {
    return std::any_of(checks.begin(), checks.end(), [&](const Check& c) {
        return c.name == name;
    });
}

template <class Number>
bool read(std::string_view text, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size();
}

std::optional<Request> parse(const std::vector<std::string_view>& words) {
    Request request;
    for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
        const std::string_view value = words[i + 1];
        bool good = false;
        if (words[i] == "--rays") good = read(value, request.options.rays);
        if (words[i] == "--seed") good = read(value, request.options.seed);
        if (words[i] == "--threads") good = read(value, request.options.threads);
        if (words[i] == "--check") {
            good = is_check(value);
            request.names.push_back(value);
        }
        if (!good) return std::nullopt;
    }
    if (words.size() % 2 != 0) return std::nullopt;
    return request;
}

} // namespace

int main(int argc, char** argv) {
    const auto request = parse({argv + 1, argv + argc});
    if (!request) {
        std::fputs(
            "usage: raywise_verify [--rays N] [--seed S] [--threads T] [--check NAME]...\n", stderr
        );
        return 2;
    }
    bool all_right = true;
    for (const Check& check : checks) {
        const auto& names = request->names;
        if (!names.empty() && std::find(names.begin(), names.end(), check.name) == names.end())
            continue;
        const Outcome outcome = check.run(request->options);
        std::printf(
            "%s: %llu rays, %llu wrong\n",
            check.name.data(),
            static_cast<unsigned long long>(outcome.rays),
            static_cast<unsigned long long>(outcome.wrong)
        );
        std::fflush(stdout);
        all_right = all_right && outcome.wrong == 0 && outcome.rays != 0;
    }
    return all_right ? 0 : 1;
}
