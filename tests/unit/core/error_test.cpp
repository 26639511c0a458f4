#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

#include <string>

namespace raywise {
namespace {

TEST(Error, NamesFileLineAndReason) {
    const Error error("scene.obj", at_line(41), "face refers to vertex 17 of 12");
    EXPECT_STREQ(error.what(), "scene.obj:41: face refers to vertex 17 of 12");
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_EQ(error.path(), "scene.obj");
    EXPECT_EQ(error.place().number, 41U);
}

TEST(Error, NamesFileByteAndReason) {
    EXPECT_STREQ(Error("a.ply", at_byte(120), "cut short").what(), "a.ply: byte 120: cut short");
}

TEST(Error, WithoutAFileIsTheReasonAlone) {
    EXPECT_STREQ(Error("no triangles").what(), "no triangles");
}

TEST(Error, IsOneLineOfAtMost300BytesWhateverTheInput) {
    const std::string hostile(5000, '\n');
    const std::string what = Error(hostile, at_line(1), hostile).what();
    EXPECT_LE(what.size(), 300U);
    EXPECT_EQ(what.find('\n'), std::string::npos);
}

TEST(Error, KeepsTheEndOfALongPathAndTheWholeReason) {
    const std::string path = std::string(500, 'd') + "/scene.obj";
    const std::string what = Error(path, at_line(7), "a short reason").what();
    EXPECT_NE(what.find("/scene.obj:7: a short reason"), std::string::npos);
}

TEST(Escaped, LeavesUtf8AndEscapesTheRest) {
    EXPECT_EQ(escaped("caf\xC3\xA9 \xE2\x82\xAC"), "caf\xC3\xA9 \xE2\x82\xAC");
    EXPECT_EQ(escaped("\x1B[31m\x7F"), "\\x1b[31m\\x7f");
    EXPECT_EQ(escaped("\xFF\xC3"), "\\xff\\xc3");
    EXPECT_EQ(escaped("\xC0\x80"), "\\xc0\\x80") << "an overlong form is not UTF-8";
}

TEST(Escaped, CutsBetweenCharactersAndSaysSo) {
    EXPECT_EQ(escaped("abcdefgh", 8), "abcdefgh");
    EXPECT_EQ(escaped("abcdefghi", 8), "abcde...");
    EXPECT_EQ(escaped("abcd\xC3\xA9ghi", 8), "abcd...") << "no half character before the dots";
    EXPECT_EQ(escaped("", 8), "");
}

} // namespace
} // namespace raywise
