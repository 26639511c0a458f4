#include <raywise/io/output_file.hpp>

#include <raywise/core/error.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>
#include <system_error>

namespace raywise {

namespace {

[[noreturn]] void refuse(const std::string& path, std::string_view what, int code) {
    throw Error(
        ErrorKind::io,
        path,
        nowhere(),
        std::string(what) + ": " + std::generic_category().message(code)
    );
}

/// An open file that is closed, and removed unless kept, on every way out.
class PendingFile {
public:
    PendingFile(std::string path, const std::string& shown, int flags)
        : path_(std::move(path))
        , shown_(shown)
        , descriptor_(::open(path_.c_str(), flags | O_CLOEXEC, 0666)) {
        if (descriptor_ < 0) refuse(shown_, "cannot be written", errno);
        is_temporary_ = (flags & O_EXCL) != 0;
    }

    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    ~PendingFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (is_temporary_) ::unlink(path_.c_str());
    }

    void write(std::span<const std::byte> bytes) const {
        while (!bytes.empty()) {
            const ::ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) refuse(shown_, "cannot be written", errno);
            bytes = bytes.subspan(static_cast<std::size_t>(written));
        }
    }

    void close() {
        // Some file systems tell only now that the disk is full.
        const int descriptor = descriptor_;
        descriptor_ = -1;
        if (::close(descriptor) != 0) refuse(shown_, "cannot be written", errno);
    }

    void move_to(const std::string& destination) {
        if (::rename(path_.c_str(), destination.c_str()) != 0)
            refuse(shown_, "cannot be written", errno);
        is_temporary_ = false;
    }

private:
    std::string path_;
    const std::string& shown_;
    int descriptor_;
    bool is_temporary_ = false;
};

/// Whether moving a file onto `path` would replace what is not an ordinary file: a device, a pipe.
bool is_special(const std::string& path) {
    struct ::stat status{};
    return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

/// A name beside `path` that no other thread or process is using.
std::string temporary_name(const std::string& path) {
    static std::atomic<std::uint64_t> serial = 0;
    return path + "." + std::to_string(::getpid()) + "-" + std::to_string(serial++) + ".part";
}

} // namespace

void write_file(const std::string& path, std::span<const std::byte> bytes) {
    if (is_special(path)) {
        PendingFile file(path, path, O_WRONLY);
        file.write(bytes);
        file.close();
        return;
    }
    PendingFile file(temporary_name(path), path, O_WRONLY | O_CREAT | O_EXCL);
    file.write(bytes);
    file.close();
    file.move_to(path);
}

void write_file(const std::string& path, std::string_view text) {
    write_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

} // namespace raywise
