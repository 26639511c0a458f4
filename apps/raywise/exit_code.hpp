// What the program's exit code says (docs/cli.md).
#pragma once

#include <raywise/core/error.hpp>

#include <stdexcept>

namespace raywise::app {

enum class ExitCode : int {
    ok = 0,
    usage = 2,        ///< the command line itself
    input = 3,        ///< a file or its content is refused
    limit = 4,        ///< a resource limit, or no memory
    io = 5,           ///< the file system, a full disk, a closed pipe
    check_failed = 6, ///< the program found that its own answer is wrong
    signal = 128,     ///< plus the number of the signal that stopped it
};

[[nodiscard]] constexpr ExitCode exit_code(ErrorKind kind) {
    switch (kind) {
    case ErrorKind::limit:
        return ExitCode::limit;
    case ErrorKind::io:
        return ExitCode::io;
    case ErrorKind::input:
        break;
    }
    return ExitCode::input;
}

/// The command line cannot be followed.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// An answer differs from its oracle.
class CheckFailed : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

} // namespace raywise::app
