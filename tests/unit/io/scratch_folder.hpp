// A folder of its own for a test's files, removed at the end.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace raywise::testing_io {

class ScratchFolder {
public:
    ScratchFolder() {
        // In memory where the system offers it: some tests write thousands of files.
        std::filesystem::path base = "/dev/shm";
        if (::access(base.c_str(), W_OK | X_OK) != 0) base = std::filesystem::temp_directory_path();
        std::string pattern = (base / "raywise-test-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
        path_ = pattern;
    }

    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    ScratchFolder(ScratchFolder&&) = delete;
    ScratchFolder& operator=(ScratchFolder&&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

    /// Writes a file of these bytes; its path.
    std::filesystem::path write(const std::string& name, std::string_view bytes) const {
        std::ofstream file(path_ / name, std::ios::binary | std::ios::trunc);
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return path_ / name;
    }

    /// The number of files in it.
    [[nodiscard]] std::size_t count() const {
        std::size_t files = 0;
        for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(path_))
            ++files;
        return files;
    }

private:
    std::filesystem::path path_;
};

} // namespace raywise::testing_io
