// Ray and hit files: round trips, files as numpy writes them, and malformed ones.
#include <raywise/io/ray_file.hpp>

#include "refusals.hpp"
#include "scratch_folder.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/io/files.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace raywise {
namespace {

using testing::HasSubstr;
using testing_io::refusal_of;
using testing_io::ScratchFolder;

std::vector<Ray> some_rays(std::size_t count) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(1, i);
        rays.push_back(
            {{rng.uniform(), rng.uniform(), rng.uniform()},
             {rng.uniform() - 2, 0, rng.uniform()},
             rng.uniform(),
             2 + rng.uniform()}
        );
    }
    rays[0].t_max = std::numeric_limits<float>::infinity();
    return rays;
}

bool is_same(const Ray& a, const Ray& b) {
    return a.origin == b.origin && a.direction == b.direction && a.t_min == b.t_min &&
           a.t_max == b.t_max;
}

/// An array as numpy writes it.
std::string
npy(const std::string& type,
    const std::string& shape,
    const std::string& data,
    const std::string& order = "False") {
    const std::string text =
        "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
    return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(text.size()) + '\0' + text +
           data;
}

template <class T>
std::string numbers(const std::vector<T>& values, bool is_big = false) {
    std::string bytes;
    for (const T value : values) {
        std::string raw(sizeof(T), '\0');
        std::memcpy(raw.data(), &value, sizeof(T));
        if (is_big) raw = std::string(raw.rbegin(), raw.rend());
        bytes += raw;
    }
    return bytes;
}

class RayFiles : public testing::Test {
protected:
    std::vector<Ray> read(const std::string& bytes, const std::string& name = "rays.npy") {
        return load_rays(folder_.write(name, bytes));
    }

    std::string refusal(const std::string& bytes, const std::string& name = "rays.npy") {
        return refusal_of([&] { (void)read(bytes, name); }).value_or("accepted");
    }

    ScratchFolder folder_;
};

TEST_F(RayFiles, ComeBackBitForBit) {
    const std::vector<Ray> rays = some_rays(100);
    save_rays(folder_.path() / "rays.npy", rays);
    const std::vector<Ray> back = load_rays(folder_.path() / "rays.npy");
    ASSERT_EQ(back.size(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
        EXPECT_TRUE(is_same(back[i], rays[i])) << i;
    save_rays(folder_.path() / "rays.npy", {});
    EXPECT_TRUE(load_rays(folder_.path() / "rays.npy").empty());
}

TEST_F(RayFiles, TakeEitherByteOrderPrecisionAndLayout) {
    const std::vector<float> row{1, 2, 3, 0, 0, 1, 0.5F, 9};
    const std::vector<double> wide{1, 2, 3, 0, 0, 1, 0.5, 9};
    const Ray expected{{1, 2, 3}, {0, 0, 1}, 0.5F, 9};
    for (const std::string& bytes :
         {npy("<f4", "(1, 8)", numbers(row)),
          npy(">f4", "(1, 8)", numbers(row, true)),
          npy("<f8", "(1, 8)", numbers(wide)),
          npy(">f8", "(1, 8)", numbers(wide, true)),
          npy("<f4", "(1, 8)", numbers(row), "True")})
        EXPECT_TRUE(is_same(read(bytes).at(0), expected));
    // Fortran order: the columns one after the other.
    const std::vector<Ray> two =
        read(npy("<f4", "(2, 6)", numbers<float>({1, 4, 2, 5, 3, 6, 0, 1, 0, 1, 1, 1}), "True"));
    EXPECT_TRUE(is_same(two.at(0), {{1, 2, 3}, {0, 0, 1}}));
    EXPECT_TRUE(is_same(two.at(1), {{4, 5, 6}, {1, 1, 1}}));
}

TEST_F(RayFiles, RefuseMalformedArrays) {
    const std::string data = numbers<float>({1, 2, 3, 0, 0, 1, 0, 9});
    EXPECT_EQ(refusal(npy("<f4", "(1, 8)", data)), "accepted");
    EXPECT_THAT(refusal(""), HasSubstr("not a .npy array"));
    EXPECT_THAT(refusal(npy("<f4", "(2, 8)", data)), HasSubstr("more than the file holds"));
    EXPECT_THAT(
        refusal(npy("<f4", "(4294967295, 4294967295)", data)), HasSubstr("more than the file holds")
    );
    EXPECT_THAT(refusal(npy("<f4", "(99999999999999999999, 8)", data)), HasSubstr("shape"));
    EXPECT_THAT(refusal(npy("<f4", "(1, 8)", data + "x")), HasSubstr("more data than its shape"));
    EXPECT_THAT(refusal(npy("<f4", "(8,)", data)), HasSubstr("shape (N, 8)"));
    EXPECT_THAT(refusal(npy("<f4", "(2, 2, 2)", data)), HasSubstr("shape"));
    EXPECT_THAT(refusal(npy("<f4", "()", data)), HasSubstr("single number"));
    EXPECT_THAT(refusal(npy("<i4", "(1, 8)", data)), HasSubstr("type '<i4' is not supported"));
    EXPECT_THAT(refusal(npy("|O", "(1, 8)", data)), HasSubstr("not supported"));
    EXPECT_THAT(refusal(npy("<f4", "(1, 8), 'shape': (1, 8)", data)), HasSubstr("repeated"));
    EXPECT_THAT(refusal("x", "rays.txt"), HasSubstr("suffix"));
}

TEST_F(RayFiles, RefuseRaysThatAreNotValid) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    for (const std::vector<float>& row : std::vector<std::vector<float>>{
             {nan, 2, 3, 0, 0, 1, 0, 9},
             {infinity, 2, 3, 0, 0, 1, 0, 9},
             {1, 2, 3, 0, 0, 0, 0, 9},
             {1, 2, 3, 0, 0, 1, 2, 1},
             {1, 2, 3, 0, 0, 1, -1, 1},
             {1, 2, 3, 0, 0, 1, nan, 1}
         })
        EXPECT_THAT(refusal(npy("<f4", "(1, 8)", numbers(row))), HasSubstr("ray 0 is not valid"));
    EXPECT_THAT(
        refusal(npy("<f8", "(1, 6)", numbers<double>({1e39, 2, 3, 0, 0, 1}))),
        HasSubstr("ray 0 is not valid")
    );
}

TEST_F(RayFiles, KeepWeightsInArchives) {
    std::vector<RecordedRay> recorded;
    for (const Ray& ray : some_rays(20))
        recorded.push_back({ray, 0.1 * static_cast<double>(recorded.size())});
    save_recorded_rays(folder_.path() / "record.npz", recorded);
    const std::vector<RecordedRay> back = load_recorded_rays(folder_.path() / "record.npz");
    ASSERT_EQ(back.size(), recorded.size());
    for (std::size_t i = 0; i < back.size(); ++i) {
        EXPECT_TRUE(is_same(back[i].ray, recorded[i].ray));
        EXPECT_EQ(back[i].weight, recorded[i].weight);
    }
    EXPECT_EQ(load_rays(folder_.path() / "record.npz").size(), 20U);
}

TEST_F(RayFiles, ReadDeflatedMembersOfZipFiles) {
    // numpy.savez_compressed("rays.npz", rays=numpy.array([[1, 2, 3, 0, 0, 1]], "<f4"))
    std::string hex =
        "504b03042d000000080000002100a6285ea3ffffffffffffffff08001400726179732e6e70790100"
        "1000980000000000000055000000000000009bec17ea1b10c9c850c650ad9e925a9c5ca46ea5a06e"
        "9366a2aea3a09e965f54529498179f5f94920a12774bcc294e058a17672416a402f91a863a0a669a"
        "3a0ab50a64032e0686067b060606072002621868b00700504b01022d032d000000080000002100a6"
        "285ea35500000098000000080000000000000000000000800100000000726179732e6e7079504b05"
        "060000000001000100360000008f0000000000";
    std::string bytes;
    for (std::size_t i = 0; i < hex.size(); i += 2)
        bytes.push_back(static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
    const std::vector<Ray> rays = read(bytes, "rays.npz");
    ASSERT_EQ(rays.size(), 1U);
    EXPECT_TRUE(is_same(rays[0], {{1, 2, 3}, {0, 0, 1}}));
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_NE(refusal(bytes.substr(0, size), "rays.npz"), "accepted") << size;
    const std::size_t refused =
        testing_io::refused_mutations(bytes, 3000, [&](const std::string& changed) {
            (void)read(changed, "rays.npz");
        });
    EXPECT_GT(refused, 2000U);
}

TEST_F(RayFiles, SurviveTruncationAndMutation) {
    save_rays(folder_.path() / "whole.npy", some_rays(3));
    const std::string whole = read_file(folder_.path() / "whole.npy");
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_NE(refusal(whole.substr(0, size)), "accepted") << size;
    const std::size_t refused =
        testing_io::refused_mutations(whole, 3000, [&](const std::string& changed) {
            (void)read(changed);
        });
    EXPECT_GT(refused, 1000U);
}

TEST_F(RayFiles, HitsComeBackBitForBit) {
    const std::filesystem::path path = folder_.path() / "hits.npz";
    const std::vector<std::optional<Hit>> hits{
        Hit{1.5F, 0.25F, 0.5F, to_prim(7), true},
        std::nullopt,
        Hit{0, 0, 1, to_prim(0xFFFFFFFE), false}
    };
    save_hits(path, hits);
    const std::vector<std::optional<Hit>> back = load_hits(path);
    ASSERT_EQ(back.size(), 3U);
    EXPECT_FALSE(back[1]);
    for (const std::size_t i : {0U, 2U}) {
        EXPECT_EQ(back[i]->t, hits[i]->t);
        EXPECT_EQ(back[i]->u, hits[i]->u);
        EXPECT_EQ(back[i]->v, hits[i]->v);
        EXPECT_EQ(back[i]->prim, hits[i]->prim);
        EXPECT_EQ(back[i]->front, hits[i]->front);
    }
    save_hits(path, {});
    EXPECT_TRUE(load_hits(path).empty());
}

TEST_F(RayFiles, HitsRefuseEveryTruncationAndMostMutations) {
    save_hits(
        folder_.path() / "whole.npz",
        std::vector<std::optional<Hit>>{Hit{1, 0, 0, to_prim(3), true}, std::nullopt}
    );
    const std::string whole = read_file(folder_.path() / "whole.npz");
    const auto read_hits = [&](const std::string& bytes) {
        (void)load_hits(folder_.write("hits.npz", bytes));
    };
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_TRUE(refusal_of([&] { read_hits(whole.substr(0, size)); })) << size;
    EXPECT_GT(testing_io::refused_mutations(whole, 3000, read_hits), 2000U);
}

} // namespace
} // namespace raywise
