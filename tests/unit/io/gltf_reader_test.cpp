// glTF and GLB: what the format says, and every index, count and path that lies.
#include "refusals.hpp"
#include "scratch_folder.hpp"

#include <raywise/io/files.hpp>
#include <raywise/io/load_scene.hpp>
#include <raywise/io/save_scene.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace raywise {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing_io::refusal_of;
using testing_io::ScratchFolder;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

std::string base64(const std::string& bytes) {
    constexpr const char* digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word =
                word << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (unsigned k = 0; k < 4; ++k)
            text.push_back(i + k > bytes.size() ? '=' : digits[word >> (18U - 6U * k) & 63U]);
    }
    return text;
}

template <class T>
std::string raw(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

/// A unit square of four vertices (48 bytes) and six 16-bit indices (12 bytes), as one node.
json square(std::string* data = nullptr) {
    const std::string bytes =
        raw<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + raw<std::uint16_t>({0, 1, 2, 0, 2, 3});
    if (data != nullptr) *data = bytes;
    json document =
        json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "square"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": 60}]})");
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(bytes);
    return document;
}

class GltfReader : public testing::Test {
protected:
    Scene read(const json& document, const LoadOptions& options = {}) {
        return load_scene(folder_.write("scene.gltf", document.dump()), options, report_);
    }

    std::string refusal(const json& document) {
        return refusal_of([&] { (void)read(document); }).value_or("accepted");
    }

    /// The refusal of the square after a change.
    std::string refusal_after(const std::function<void(json&)>& change) {
        json document = square();
        change(document);
        return refusal(document);
    }

    ScratchFolder folder_;
    LoadReport report_;
};

TEST_F(GltfReader, ReadsIndexedTriangles) {
    const Scene scene = read(square());
    EXPECT_EQ(scene.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(scene.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(scene.groups, (std::vector<Group>{{"square", 0, 2}}));
}

TEST_F(GltfReader, ReadsStripsFansAndBareVertices) {
    json document = square();
    json& primitive = document["meshes"][0]["primitives"][0];
    primitive.erase("indices");
    primitive["mode"] = 5;
    EXPECT_EQ(read(document).triangles, (Triangles{{0, 1, 2}, {1, 3, 2}}));
    primitive["mode"] = 6;
    EXPECT_EQ(read(document).triangles, (Triangles{{1, 2, 0}, {2, 3, 0}}));
    primitive["mode"] = 4;
    EXPECT_THAT(refusal(document), HasSubstr("4 corners make no whole triangles"));
    primitive["mode"] = 1;
    EXPECT_THAT(refusal(document), HasSubstr("no triangles"));
}

TEST_F(GltfReader, PlacesNodesByAllTheirParents) {
    json document = square();
    document["nodes"] =
        json::parse(R"([{"children": [1, 2], "translation": [10, 0, 0], "scale": [2, 2, 2]},
        {"mesh": 0, "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]},
        {"mesh": 0, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}])");
    const Scene scene = read(document);
    ASSERT_EQ(scene.vertices.size(), 8U);
    EXPECT_NEAR(scene.vertices[1].x, 10, 1e-6); // (1, 0, 0) turned to y, doubled, moved
    EXPECT_NEAR(scene.vertices[1].y, 2, 1e-6);
    EXPECT_EQ(scene.vertices[5], (Vec3{8, 0, 10}));
    // A mirroring node turns the triangles around, so that their fronts stay in front.
    EXPECT_EQ(scene.triangles[2], (std::array<std::uint32_t, 3>{4, 6, 5}));
}

TEST_F(GltfReader, ExpandsInstances) {
    json document = square();
    document["buffers"][0]["byteLength"] = 84;
    std::string data;
    (void)square(&data);
    document["buffers"][0]["uri"] = "data:;base64," + base64(data + raw<float>({0, 0, 1, 0, 0, 2}));
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 24}});
    document["accessors"].push_back(
        {{"bufferView", 2}, {"componentType", 5126}, {"count", 2}, {"type", "VEC3"}}
    );
    document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = 2;
    document["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const Scene scene = read(document);
    EXPECT_EQ(scene.triangles.size(), 4U);
    EXPECT_EQ(scene.vertices[4], (Vec3{0, 0, 2}));
    EXPECT_EQ(scene.groups.size(), 2U);
}

TEST_F(GltfReader, AppliesSparseReplacementsAndStrides) {
    json document = square();
    std::string data;
    (void)square(&data);
    data += raw<std::uint16_t>({1, 3}) + raw<float>({9, 0, 0, 0, 9, 0});
    document["buffers"][0] = {{"byteLength", data.size()}, {"uri", "data:;base64," + base64(data)}};
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 4}});
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 64}, {"byteLength", 24}});
    json sparse = {
        {"count", 2},
        {"indices", {{"bufferView", 2}, {"componentType", 5123}}},
        {"values", {{"bufferView", 3}}}
    };
    document["accessors"][0]["sparse"] = sparse;
    EXPECT_EQ(
        read(document).vertices, (std::vector<Vec3>{{0, 0, 0}, {9, 0, 0}, {1, 1, 0}, {0, 9, 0}})
    );
    // Without a buffer view the rest is zeros.
    document["accessors"][0].erase("bufferView");
    EXPECT_EQ(
        read(document).vertices, (std::vector<Vec3>{{0, 0, 0}, {9, 0, 0}, {0, 0, 0}, {0, 9, 0}})
    );
    document["accessors"][0]["count"] = 2'000'000'000;
    EXPECT_THAT(refusal(document), HasSubstr("zeros, more than the file has bytes"));
    document["accessors"][0]["count"] = 3;
    EXPECT_THAT(refusal(document), HasSubstr("refers to element 3 of 3"));
    // Every second vertex.
    json strided = square();
    strided["bufferViews"][0]["byteStride"] = 24;
    strided["accessors"][0]["count"] = 2;
    strided["meshes"][0]["primitives"][0]["mode"] = 4;
    EXPECT_THAT(refusal(strided), HasSubstr("refers to vertex 2 of 2"));
    strided["accessors"][0]["count"] = 3;
    EXPECT_THAT(refusal(strided), HasSubstr("end beyond the buffer view"));
}

TEST_F(GltfReader, ReadsQuantizedPositions) {
    json document = square();
    std::string data = raw<std::uint8_t>({0, 0, 0, 0, 255, 0, 0, 0, 255, 255, 0, 0, 0, 255, 0, 0});
    data += raw<std::uint8_t>({0, 1, 2, 0, 2, 3});
    document["buffers"][0] = {{"byteLength", data.size()}, {"uri", "data:;base64," + base64(data)}};
    document["bufferViews"] = json::parse(
        R"([{"buffer": 0, "byteLength": 16, "byteStride": 4}, {"buffer": 0, "byteOffset": 16, "byteLength": 6}])"
    );
    document["accessors"][0]["componentType"] = 5121;
    document["accessors"][0]["normalized"] = true;
    document["accessors"][1]["componentType"] = 5121;
    document["extensionsRequired"] = {"KHR_mesh_quantization"};
    EXPECT_EQ(read(document).vertices, read(square()).vertices);
}

TEST_F(GltfReader, ReadsLightsAndCameras) {
    json document = square();
    document["extensions"]["KHR_lights_punctual"]["lights"] = json::parse(
        R"([{"type": "spot", "spot": {"outerConeAngle": 0.5}, "range": 7}, {"type": "directional", "name": "sun"}])"
    );
    document["cameras"] = json::parse(
        R"([{"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 2, "znear": 0.5}},
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 9}}])"
    );
    document["nodes"] = json::parse(R"([{"mesh": 0, "children": [1, 2, 3]},
        {"translation": [1, 2, 3], "camera": 0, "name": "eye"},
        {"rotation": [0.7071067811865476, 0, 0, 0.7071067811865476], "camera": 1, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"extensions": {"KHR_lights_punctual": {"light": 1}}}])");
    const Scene scene = read(document);
    ASSERT_EQ(scene.lights.size(), 2U);
    EXPECT_EQ(scene.lights[0].kind, LightKind::spot);
    EXPECT_NEAR(scene.lights[0].direction.y, 1, 1e-12); // -z turned about x
    EXPECT_EQ(scene.lights[0].range, 7);
    EXPECT_EQ(scene.lights[0].cone_rad, 0.5);
    EXPECT_EQ(scene.lights[1].name, "sun");
    ASSERT_EQ(scene.cameras.size(), 2U);
    EXPECT_EQ(scene.cameras[0].name, "eye");
    EXPECT_EQ(scene.cameras[0].eye, (Vec3d{1, 2, 3}));
    EXPECT_EQ(scene.cameras[0].frame.forward, (Vec3d{0, 0, -1}));
    EXPECT_NEAR(std::tan(scene.cameras[0].fov_x_rad / 2), 2 * std::tan(0.5), 1e-12);
    EXPECT_EQ(scene.cameras[1].projection, Projection::orthographic);
    EXPECT_EQ(scene.cameras[1].half_width, 3);
}

TEST_F(GltfReader, RefusesRequiredExtensionsByName) {
    for (const std::string name :
         {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "X_unknown"})
        EXPECT_THAT(
            refusal_after([&](json& d) { d["extensionsRequired"] = {name}; }), HasSubstr(name)
        );
    EXPECT_EQ(
        refusal_after([](json& d) { d["extensionsRequired"] = {"KHR_materials_unlit"}; }),
        "accepted"
    );
}

TEST_F(GltfReader, RefusesIndicesAndCountsThatLie) {
    using Change = std::function<void(json&)>;
    const std::vector<std::pair<Change, std::string>> cases{
        {[](json& d) { d["asset"]["version"] = "1.0"; }, "asset.version: must be 2.x"},
        {[](json& d) { d.erase("asset"); }, "needs a key 'asset'"},
        {[](json& d) { d["scene"] = 1; }, "scene: refers to scenes[1] of 1"},
        {[](json& d) { d["scenes"][0]["nodes"] = {1}; },
         "scenes[0].nodes[0]: refers to nodes[1] of 1"},
        {[](json& d) { d["scenes"][0]["nodes"] = {-1}; }, "must be an integer that is not negative"
        },
        {[](json& d) { d["scenes"][0]["nodes"] = {0, 0}; }, "nodes[0]: is reached twice"},
        {[](json& d) { d["nodes"][0]["children"] = {0}; }, "nodes[0]: is reached twice"},
        {[](json& d) { d["nodes"][0]["mesh"] = 1; }, "refers to meshes[1] of 1"},
        {[](json& d) { d["nodes"][0]["mesh"] = 0.5; }, "must be an integer"},
        {[](json& d) { d["nodes"][0]["skin"] = 0; }, "has a skin"},
        {[](json& d) { d["nodes"][0]["rotation"] = {0, 0, 0, 0}; }, "is not a unit quaternion"},
        {[](json& d) { d["nodes"][0]["scale"] = {1, 1}; }, "must have 3 numbers"},
        {[](json& d) { d["nodes"][0]["scale"] = {1e300, 1, 1}; }, "not finite in single precision"},
        {[](json& d) { d["nodes"][0]["matrix"] = {1, 2}; }, "must have 16 numbers"},
        {[](json& d) { d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 2; },
         "refers to accessors[2] of 2"},
        {[](json& d) { d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 1; },
         "has type SCALAR"},
        {[](json& d) { d["meshes"][0]["primitives"][0]["indices"] = 0; }, "has type VEC3"},
        {[](json& d) { d["meshes"][0]["primitives"][0]["mode"] = 7; }, "must be at most 6"},
        {[](json& d) { d["accessors"][1].update({{"componentType", 5126}, {"count", 3}}); },
         "must be unsigned integers"},
        {[](json& d) { d["accessors"][1]["componentType"] = 5124; }, "5124 is not a component type"
        },
        {[](json& d) { d["accessors"][0]["count"] = 0; }, "accessors[0]: has no elements"},
        {[](json& d) { d["accessors"][0]["count"] = 5; }, "end beyond the buffer view"},
        {[](json& d) { d["accessors"][0]["count"] = 3000000000U; }, "must be at most 2147483647"},
        {[](json& d) { d["accessors"][0]["byteOffset"] = 4; }, "end beyond the buffer view"},
        {[](json& d) { d["accessors"][0]["byteOffset"] = 1ULL << 63U; }, "must be at most"},
        {[](json& d) { d["accessors"][0]["bufferView"] = 2; }, "refers to bufferViews[2] of 2"},
        {[](json& d) { d["accessors"][0]["count"] = 3; }, "index 5 refers to vertex 3 of 3"},
        {[](json& d) { d["bufferViews"][0]["byteLength"] = 61; },
         "ends beyond its buffer of 60 bytes"},
        {[](json& d) { d["bufferViews"][0]["byteStride"] = 3; }, "byteStride"},
        {[](json& d) { d["bufferViews"][0]["byteStride"] = 8; }, "end beyond the buffer view"},
        {[](json& d) { d["bufferViews"][0]["buffer"] = 1; }, "refers to buffers[1] of 1"},
        {[](json& d) { d["buffers"][0]["byteLength"] = 61; }, "says 61 bytes, but there are 60"},
        {[](json& d) { d["buffers"][0].erase("uri"); }, "neither a uri nor a binary chunk"},
        {[](json& d) { d["buffers"][0]["uri"] = "data:;base64,AAA"; }, "malformed base64"},
        {[](json& d) { d["buffers"][0]["uri"] = "data:text/plain,AAAA"; }, "without base64"},
        {[](json& d) { d["meshes"] = 7; }, "must be an array"},
    };
    EXPECT_EQ(refusal(square()), "accepted");
    for (const auto& [change, reason] : cases)
        EXPECT_THAT(refusal_after(change), HasSubstr(reason));
}

TEST_F(GltfReader, RefusesFilesOutsideItsFolder) {
    std::string data;
    (void)square(&data);
    std::filesystem::create_directory(folder_.path() / "inner");
    folder_.write("outside.bin", data);
    folder_.write("inner/in side.bin", data);
    std::filesystem::create_symlink("../outside.bin", folder_.path() / "inner" / "link.bin");
    const auto refusal_of_uri = [&](const std::string& uri) {
        json document = square();
        document["buffers"][0]["uri"] = uri;
        const auto path = folder_.write("inner/scene.gltf", document.dump());
        return refusal_of([&] { (void)load_scene(path); }).value_or("accepted");
    };
    EXPECT_EQ(refusal_of_uri("in%20side.bin"), "accepted");
    EXPECT_THAT(refusal_of_uri("../outside.bin"), HasSubstr("leaves the folder"));
    EXPECT_THAT(refusal_of_uri("%2e%2e/outside.bin"), HasSubstr("leaves the folder"));
    EXPECT_THAT(refusal_of_uri("link.bin"), HasSubstr("leaves the folder"));
    EXPECT_NE(refusal_of_uri((folder_.path() / "outside.bin").string()), "accepted");
    EXPECT_THAT(refusal_of_uri("/dev/zero"), HasSubstr("absolute"));
    EXPECT_THAT(refusal_of_uri("http://example.org/a.bin"), HasSubstr("in the scene's folder"));
    EXPECT_THAT(refusal_of_uri("file:a.bin"), HasSubstr("in the scene's folder"));
    EXPECT_NE(refusal_of_uri("missing.bin"), "accepted");
    EXPECT_NE(refusal_of_uri("%"), "accepted");
    EXPECT_NE(refusal_of_uri("."), "accepted"); // a folder
}

TEST_F(GltfReader, RefusesWhatIsNotJson) {
    const auto refusal_of_text = [&](const std::string& text) {
        const auto path = folder_.write("scene.gltf", text);
        return refusal_of([&] { (void)load_scene(path); }).value_or("accepted");
    };
    EXPECT_THAT(refusal_of_text("{\n\"asset\": }"), HasSubstr(":2: not JSON"));
    EXPECT_THAT(refusal_of_text("[]"), HasSubstr("must be an object"));
    EXPECT_THAT(refusal_of_text("{\"a\": 1, \"a\": 2}"), HasSubstr("key 'a' is repeated"));
    EXPECT_THAT(refusal_of_text("{\"a\": 1e999}"), HasSubstr("not JSON"));
    EXPECT_THAT(refusal_of_text("{\"a\": NaN}"), HasSubstr("not JSON"));
    EXPECT_THAT(refusal_of_text("{\"a\": \"\xFF\"}"), HasSubstr("not JSON"));
    EXPECT_THAT(
        refusal_of_text(std::string(1'000'000, '[')), HasSubstr("nested more than 64 deep")
    );
    EXPECT_THAT(
        refusal_of_text("{\"a\":" + std::string(1'000'000, '{')),
        HasSubstr("nested more than 64 deep")
    );
}

TEST_F(GltfReader, WalksLongChainsOfNodes) {
    json document = square();
    document["nodes"] = json::array();
    constexpr int length = 20'000;
    for (int i = 0; i < length; ++i)
        document["nodes"].push_back({{"children", {i + 1}}});
    document["nodes"].push_back({{"mesh", 0}});
    EXPECT_EQ(read(document).triangles.size(), 2U);
}

TEST_F(GltfReader, CountsInstancesBeforeExpandingThem) {
    json document = square();
    document["nodes"] = json::array();
    document["scenes"][0]["nodes"] = json::array();
    for (int i = 0; i < 1000; ++i) {
        document["nodes"].push_back({{"mesh", 0}});
        document["scenes"][0]["nodes"].push_back(i);
    }
    const std::size_t all = 4000 * 12 + 2000 * 12;
    EXPECT_EQ(read(document).triangles.size(), 2000U);
    EXPECT_THAT(
        refusal_of([&] { (void)read(document, {.max_bytes = all}); }).value_or("accepted"),
        HasSubstr("memory limit")
    );
}

TEST_F(GltfReader, ComesBackFromGlbWithGroupsLightsAndCameras) {
    Scene scene = generate_courtyard({.triangles = 100, .seed = 1});
    Camera across;
    across.projection = Projection::orthographic;
    across.near = 1;
    across.far = 10;
    scene.cameras.push_back(across);
    Light spot = scene.lights[1];
    spot.kind = LightKind::spot;
    spot.cone_rad = 0.7;
    scene.lights.push_back(spot);
    const std::filesystem::path path = folder_.path() / "saved.glb";
    save_scene(path, scene);
    const Scene back = load_scene(path);
    EXPECT_EQ(content_hash(back), content_hash(scene));
    EXPECT_EQ(back.groups, scene.groups);
    ASSERT_EQ(back.lights.size(), scene.lights.size());
    for (std::size_t i = 0; i < back.lights.size(); ++i) {
        EXPECT_EQ(back.lights[i].kind, scene.lights[i].kind);
        EXPECT_EQ(back.lights[i].name, scene.lights[i].name);
        EXPECT_EQ(back.lights[i].range, scene.lights[i].range);
        if (scene.lights[i].kind != LightKind::point) {
            EXPECT_LT(
                length(back.lights[i].direction - normalized(scene.lights[i].direction)), 1e-12
            );
        }
        if (scene.lights[i].kind != LightKind::directional) {
            EXPECT_EQ(back.lights[i].position, scene.lights[i].position);
        }
    }
    ASSERT_EQ(back.cameras.size(), 2U);
    EXPECT_EQ(back.cameras[0].eye, scene.cameras[0].eye);
    EXPECT_LT(length(back.cameras[0].frame.right - scene.cameras[0].frame.right), 1e-12);
    EXPECT_NEAR(back.cameras[0].fov_x_rad, scene.cameras[0].fov_x_rad, 1e-12);
    EXPECT_EQ(back.cameras[1].half_width, 1);
}

TEST_F(GltfReader, RefusesEveryTruncationOfGlb) {
    Scene scene = generate_random_triangles(2);
    const std::filesystem::path path = folder_.path() / "saved.glb";
    save_scene(path, scene);
    const std::string whole = read_file(path);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        folder_.write("cut.glb", whole.substr(0, size));
        EXPECT_TRUE(refusal_of([&] { (void)load_scene(folder_.path() / "cut.glb"); })) << size;
    }
    const std::size_t refused =
        testing_io::refused_mutations(whole, 3000, [&](const std::string& bytes) {
            validate(load_scene(folder_.write("mutated.glb", bytes)));
        });
    EXPECT_GT(refused, 1000U);
    EXPECT_LT(refused, 3000U);
}

TEST_F(GltfReader, SurvivesMutations) {
    const std::string whole = square().dump();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        folder_.write("cut.gltf", whole.substr(0, size));
        EXPECT_TRUE(refusal_of([&] { (void)load_scene(folder_.path() / "cut.gltf"); })) << size;
    }
    const std::size_t refused =
        testing_io::refused_mutations(whole, 4000, [&](const std::string& text) {
            validate(load_scene(folder_.write("mutated.gltf", text)));
        });
    EXPECT_GT(refused, 1000U);
    EXPECT_LT(refused, 4000U);
}

} // namespace
} // namespace raywise
