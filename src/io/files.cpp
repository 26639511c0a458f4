#include <raywise/io/files.hpp>

#include <raywise/core/error.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace raywise {

namespace {

/// Closes a file descriptor at the end of its scope.
class Descriptor {
public:
    explicit Descriptor(int number) : number_(number) {}

    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }

    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    Descriptor(Descriptor&&) = delete;
    Descriptor& operator=(Descriptor&&) = delete;

    [[nodiscard]] int number() const { return number_; }

    /// Closes now; whether that succeeded (delayed write errors are told here).
    [[nodiscard]] bool close() { return ::close(std::exchange(number_, -1)) == 0; }

private:
    int number_;
};

[[noreturn]] void fail(const std::filesystem::path& path, std::string_view doing, int error) {
    const std::string why = std::generic_category().message(error);
    throw Error(ErrorKind::io, path.string(), nowhere(), fmt::format("cannot {}: {}", doing, why));
}

/// Removes a temporary file unless it was renamed away.
class Temporary {
public:
    explicit Temporary(std::string name) : name_(std::move(name)) {}

    ~Temporary() {
        if (!name_.empty()) ::unlink(name_.c_str());
    }

    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;
    Temporary(Temporary&&) = delete;
    Temporary& operator=(Temporary&&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }

    void keep() { name_.clear(); }

private:
    std::string name_;
};

/// Whether moving a file onto `path` would replace what is not an ordinary file: a device, a pipe.
bool is_special(const std::filesystem::path& path) {
    struct stat status{};
    return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

void write_all(const Descriptor& file, std::string_view bytes, const std::filesystem::path& path) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(file.number(), bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path, "write", errno);
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
}

/// A device or a pipe takes the bytes as they come; a folder refuses to be opened.
void write_special(const std::filesystem::path& path, std::string_view bytes) {
    Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (file.number() < 0) fail(path, "write", errno);
    write_all(file, bytes, path);
    if (!file.close()) fail(path, "write", errno);
}

} // namespace

std::string read_file(const std::filesystem::path& path, std::size_t max_bytes) {
    // Non-blocking: opening a pipe must not wait for a writer.
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    if (file.number() < 0) fail(path, "open", errno);
    struct stat status{};
    if (::fstat(file.number(), &status) != 0) fail(path, "read", errno);
    if (!S_ISREG(status.st_mode)) {
        throw Error(ErrorKind::io, path.string(), nowhere(), "not a regular file");
    }
    const auto size = static_cast<std::size_t>(status.st_size);
    if (size > max_bytes) {
        throw Error(
            ErrorKind::limit,
            path.string(),
            nowhere(),
            fmt::format("{} bytes exceed the memory limit of {}", size, max_bytes)
        );
    }
    std::string bytes(size, '\0');
    std::size_t done = 0;
    while (done < size) {
        const ssize_t count = ::read(file.number(), bytes.data() + done, size - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path, "read", errno);
        if (count == 0)
            throw Error(ErrorKind::io, path.string(), nowhere(), "shrank while it was read");
        done += static_cast<std::size_t>(count);
    }
    return bytes;
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
    if (is_special(path)) {
        write_special(path, bytes);
        return;
    }
    const std::string prefix = path.string() + "." + std::to_string(::getpid()) + ".";
    int number = -1;
    std::string name;
    for (int attempt = 0; number < 0; ++attempt) {
        name = prefix + std::to_string(attempt) + ".tmp";
        number = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (number < 0 && (errno != EEXIST || attempt == 1000)) fail(path, "write", errno);
    }
    Descriptor file(number);
    Temporary temporary(name);
    write_all(file, bytes, path);
    // Without this a crash could leave the new name with old or no content.
    if (::fsync(file.number()) != 0) fail(path, "write", errno);
    if (!file.close()) fail(path, "write", errno);
    if (::rename(temporary.name().c_str(), path.c_str()) != 0) fail(path, "write", errno);
    temporary.keep();
}

std::filesystem::path resolve_inside(
    const std::filesystem::path& folder,
    std::string_view reference,
    const std::filesystem::path& document
) {
    const auto refuse = [&](std::string_view reason) {
        throw Error(
            document.string(), nowhere(), fmt::format("'{}' {}", escaped(reference, 80), reason)
        );
    };
    if (reference.empty() || reference.find('\0') != std::string_view::npos)
        refuse("is not a file name");
    const std::filesystem::path relative(reference);
    if (relative.is_absolute()) refuse("is an absolute path; files must be in the same folder");
    if (std::find(relative.begin(), relative.end(), "..") != relative.end())
        refuse("leaves the folder of the file");
    // Symbolic links count by where they lead.
    std::error_code error;
    const std::filesystem::path root =
        std::filesystem::canonical(folder.empty() ? std::filesystem::path(".") : folder, error);
    if (error) fail(folder, "open", error.value());
    const std::filesystem::path target = std::filesystem::canonical(root / relative, error);
    if (error) fail(root / relative, "open", error.value());
    if (std::mismatch(root.begin(), root.end(), target.begin(), target.end()).first != root.end())
        refuse("leaves the folder of the file");
    return target;
}

} // namespace raywise
