#include "output.hpp"

#include <raywise/core/error.hpp>
#include <raywise/io/files.hpp>

#include <cerrno>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>

namespace raywise::app {

void put(const std::string& path, std::string_view data) {
    if (!path.empty()) {
        write_file_atomically(path, data);
        return;
    }
    if (std::fwrite(data.data(), 1, data.size(), stdout) != data.size() || std::fflush(stdout) != 0)
        throw Error(
            ErrorKind::io,
            "standard output",
            nowhere(),
            "cannot be written: " + std::generic_category().message(errno)
        );
}

} // namespace raywise::app
