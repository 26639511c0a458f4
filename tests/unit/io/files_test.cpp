// Oracle: the file system.
#include <raywise/io/files.hpp>

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace raywise {
namespace {

namespace fs = std::filesystem;

class WriteFileAtomically : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  (std::string("raywise_") +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directory(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }

    [[nodiscard]] std::ptrdiff_t count_files() const {
        return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
    }

private:
    fs::path folder_;
};

std::string content(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

ErrorKind kind_of_failure(const std::string& path) {
    try {
        write_file_atomically(path, std::string_view("text"));
    } catch (const Error& error) {
        return error.kind();
    }
    ADD_FAILURE() << "no error";
    return {};
}

TEST_F(WriteFileAtomically, ReplacesTheWholeOldFileAndLeavesNothingElse) {
    write_file_atomically(path("a"), std::string_view("a long first text"));
    write_file_atomically(path("a"), std::string_view("short"));
    EXPECT_EQ(content(path("a")), "short");
    EXPECT_EQ(count_files(), 1);
}

TEST_F(WriteFileAtomically, EmptyTextGivesAnEmptyFile) {
    write_file_atomically(path("a"), std::string_view{});
    EXPECT_EQ(fs::file_size(path("a")), 0U);
}

TEST_F(WriteFileAtomically, FullDeviceIsAnInputOutputError) {
    if (!fs::exists("/dev/full")) GTEST_SKIP();
    EXPECT_EQ(kind_of_failure("/dev/full"), ErrorKind::io);
}

TEST_F(WriteFileAtomically, MissingFolderOrAFolderInItsPlaceLeavesNothingBehind) {
    EXPECT_EQ(kind_of_failure(path("none/a")), ErrorKind::io);
    fs::create_directory(path("folder"));
    EXPECT_EQ(kind_of_failure(path("folder")), ErrorKind::io);
    EXPECT_EQ(count_files(), 1);
}

TEST_F(WriteFileAtomically, DeviceIsWrittenToAndNotReplaced) {
    write_file_atomically("/dev/null", std::string_view("text"));
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(WriteFileAtomically, SymbolicLinkToADeviceIsFollowed) {
    fs::create_symlink("/dev/null", path("link"));
    write_file_atomically(path("link"), std::string_view("text"));
    EXPECT_TRUE(fs::is_symlink(path("link")));
}

TEST(ReadFile, RefusesWhatIsNoRegularFileWithoutWaitingForIt) {
    for (const char* path : {"/dev/zero", "/dev", "no such file"})
        EXPECT_THROW((void)read_file(path), Error) << path;
}

} // namespace
} // namespace raywise
