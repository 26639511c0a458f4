// Which files are opened at all, and by which reader.
#include <raywise/io/load_scene.hpp>

#include "refusals.hpp"
#include "scratch_folder.hpp"

#include <raywise/io/save_scene.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <clocale>
#include <cstdint>
#include <filesystem>
#include <string>

namespace raywise {
namespace {

using testing::HasSubstr;
using testing_io::refusal_of;
using testing_io::ScratchFolder;

std::string refusal(const std::filesystem::path& path) {
    return refusal_of([&] { (void)load_scene(path); }).value_or("accepted");
}

TEST(LoadScene, OpensRegularFilesOnly) {
    const ScratchFolder folder;
    EXPECT_THAT(refusal(folder.path() / "missing.ply"), HasSubstr("cannot open"));
    std::filesystem::create_directory(folder.path() / "folder.ply");
    EXPECT_THAT(refusal(folder.path() / "folder.ply"), HasSubstr("not a regular file"));
    const std::filesystem::path pipe = folder.path() / "pipe.obj";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THAT(refusal(pipe), HasSubstr("not a regular file")); // and does not wait for a writer
    std::filesystem::create_symlink("/dev/zero", folder.path() / "zero.stl");
    EXPECT_THAT(refusal(folder.path() / "zero.stl"), HasSubstr("not a regular file"));
}

TEST(LoadScene, ChoosesTheReaderBySuffixInAnyCase) {
    const ScratchFolder folder;
    const Scene scene = generate_random_triangles(3);
    for (const std::string name : {"a.PLY", "a.Obj", "a.sTl", "a.glb"}) {
        save_scene(folder.path() / name, scene);
        EXPECT_EQ(content_hash(load_scene(folder.path() / name)), content_hash(scene)) << name;
    }
    for (const std::string name : {"a", "a.txt", ".ply", "ply"})
        EXPECT_THAT(refusal(folder.write(name, "ply\n")), HasSubstr("no scene format"));
    // The content must be of the suffix's format.
    std::filesystem::copy_file(folder.path() / "a.PLY", folder.path() / "b.glb");
    EXPECT_THAT(refusal(folder.path() / "b.glb"), HasSubstr("not a GLB file"));
}

TEST(LoadScene, RefusesEmptyFilesOfEveryFormat) {
    const ScratchFolder folder;
    for (const std::string name : {"a.ply", "a.obj", "a.stl", "a.gltf", "a.glb"})
        EXPECT_THAT(refusal(folder.write(name, "")), HasSubstr("empty")) << name;
}

TEST(LoadScene, DoesNotDependOnTheLocale) {
    const ScratchFolder folder;
    const std::string text = "v 0.5 0 0\nv 1.5 0 0\nv 0 1.5 0\nf 1 2 3\n";
    const std::filesystem::path path = folder.write("a.obj", text);
    const std::uint64_t hash = content_hash(load_scene(path));
    // A locale with decimal commas, where the system has one.
    for (const char* name : {"de_DE.UTF-8", "it_IT.UTF-8", "fr_FR.UTF-8"}) {
        if (std::setlocale(LC_ALL, name) == nullptr) continue;
        EXPECT_EQ(content_hash(load_scene(path)), hash);
    }
    std::setlocale(LC_ALL, "C");
}

TEST(SaveScene, LeavesNothingBehindWhenItFails) {
    const ScratchFolder folder;
    EXPECT_THROW(save_scene(folder.path() / "a.ply", Scene{}), Error);
    EXPECT_THROW(save_scene(folder.path() / "a.txt", generate_random_triangles(1)), Error);
    EXPECT_THROW(
        save_scene(folder.path() / "missing" / "a.ply", generate_random_triangles(1)), Error
    );
    std::filesystem::create_directory(folder.path() / "taken.ply");
    EXPECT_THROW(save_scene(folder.path() / "taken.ply", generate_random_triangles(1)), Error);
    Scene invalid = generate_random_triangles(1);
    invalid.triangles[0][0] = 3;
    EXPECT_THROW(save_scene(folder.path() / "a.ply", invalid), Error);
    EXPECT_EQ(folder.count(), 1U); // the folder
}

} // namespace
} // namespace raywise
