// SPDX-License-Identifier: Apache-2.0
// Binary glTF files, whose bytes are made here.

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "lib/temp_folder.h"
#include "subvol/error.h"
#include "subvol/read_surface.h"

namespace subvol {
namespace glb_test {

using Json = nlohmann::json;
using test::error_of;
using testing::HasSubstr;

std::string word(std::uint32_t number) {
    std::string bytes;
    for (int k = 0; k < 4; ++k) bytes += static_cast<char>(number >> 8 * k & 0xff);
    return bytes;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string glb(const std::string& json, const std::string& data) {
    const std::string text = json + std::string((4 - json.size() % 4) % 4, ' ');
    const std::string body = word(static_cast<std::uint32_t>(text.size())) + "JSON" + text +
                             word(static_cast<std::uint32_t>(data.size())) + std::string("BIN\0", 4) + data;
    return "glTF" + word(2) + word(static_cast<std::uint32_t>(12 + body.size())) + body;
}

/// A tetrahedron: four points, then the corners of four triangles as 16-bit numbers.
struct Scene {
    Json json;
    std::string data;

    Scene() {
        data = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3}) +
               bytes_of<std::uint16_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
        json = Json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
            "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
            "buffers": [{"byteLength": 72}]})");
    }
    [[nodiscard]] std::string bytes() const { return glb(json.dump(), data); }
};

/// The volume that a surface encloses: positive if its triangles are counter-clockwise seen from outside.
double enclosed(const Surface& surface) {
    double volume = 0;
    for (const auto& t : surface.triangles)
        volume += glm::dot(surface.points[t[0]], glm::cross(surface.points[t[1]], surface.points[t[2]])) / 6;
    return volume;
}

class Glb : public test::TempFolder {
protected:
    [[nodiscard]] Surface read(const Scene& scene) const { return read_surface(write("a.glb", scene.bytes())); }
    [[nodiscard]] std::string wrong(const std::string& bytes) const {
        return error_of([&] { std::ignore = read_surface(write("a.glb", bytes)); });
    }
    /// What is said of the scene after a change.
    [[nodiscard]] std::string wrong(const std::function<void(Json&)>& change) const {
        Scene scene;
        change(scene.json);
        return wrong(scene.bytes());
    }
};

TEST_F(Glb, HasTheTrianglesOfItsNodes) {
    const Surface one = read({});
    EXPECT_EQ(one.points.size(), 4U);
    EXPECT_EQ(one.triangles.size(), 4U);
    EXPECT_NEAR(enclosed(one), 1, 1e-12);  // 1·2·3 / 6
}

TEST_F(Glb, NodesMoveThem) {
    // A parent that moves, a child that turns about z by a right angle and makes everything twice as large.
    Scene scene;
    const double half = std::numbers::sqrt2 / 2;
    scene.json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}},
                           {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {2, 2, 2}}}};
    const Surface moved = read(scene);
    EXPECT_NEAR(enclosed(moved), 8, 1e-9);
    const auto has = [&](const Vec3& x) {
        return std::ranges::any_of(moved.points, [&](const Vec3& p) { return glm::distance(p, x) < 1e-9; });
    };
    EXPECT_TRUE(has({10, 2, 0})) << "(1,0,0) is turned to (0,1,0)";
    EXPECT_TRUE(has({6, 0, 0})) << "(0,2,0) is turned to (-2,0,0)";
    EXPECT_TRUE(has({10, 0, 6}));
    // The same as a matrix, column by column; and a mirror image keeps its outside.
    scene.json["nodes"] = {{{"mesh", 0}, {"matrix", {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 10, 0, 0, 1}}}};
    EXPECT_NEAR(enclosed(read(scene)), 8, 1e-9);
    scene.json["nodes"] = {{{"mesh", 0}, {"scale", {-1, 1, 1}}}};
    EXPECT_NEAR(enclosed(read(scene)), 1, 1e-12);
    // Two nodes of one mesh; what is not of the scene is left out.
    scene.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 5, 5}}}, {{"mesh", 0}, {"translation", {9, 9, 9}}}};
    scene.json["scenes"] = {{{"nodes", {0, 1}}}};
    EXPECT_EQ(read(scene).triangles.size(), 8U);
    scene.json.erase("scenes");
    EXPECT_EQ(read(scene).triangles.size(), 12U) << "without a scene all nodes count";
}

TEST_F(Glb, StripsFansAndOtherNumbers) {
    Scene scene;
    scene.json["accessors"][1]["count"] = 4;
    Json& primitive = scene.json["meshes"][0]["primitives"][0];
    primitive["mode"] = 6;  // fan 0 2 1, 0 1 0: the second is no triangle
    EXPECT_EQ(read(scene).triangles.size(), 1U);
    primitive["mode"] = 5;
    primitive.erase("indices");  // strip 0 1 2, 1 3 2
    const Surface strip = read(scene);
    ASSERT_EQ(strip.triangles.size(), 2U);
    const auto normal = [&](std::size_t t) {
        const auto& [a, b, c] = strip.triangles[t];
        return glm::cross(strip.points[b] - strip.points[a], strip.points[c] - strip.points[a]);
    };
    EXPECT_GT(normal(0).z, 0);
    EXPECT_LT(normal(1).z, 0) << "(1,0,0), (0,0,3), (0,2,0)";
    EXPECT_LT(normal(1).x, 0);
    primitive["mode"] = 1;  // lines
    EXPECT_THAT(wrong(scene.bytes()), HasSubstr("triangle"));
    // Normalized numbers of 16 bits, in rows of 8 bytes.
    scene = {};
    scene.data = bytes_of<std::int16_t>({0, 0, 0, 7, 32767, 0, 0, 7, 0, 32767, 0, 7, 0, 0, -32767, 7}) +
                 bytes_of<std::uint8_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
    scene.json["accessors"][0]["componentType"] = 5122;
    scene.json["accessors"][0]["normalized"] = true;
    scene.json["accessors"][1]["componentType"] = 5121;
    scene.json["bufferViews"] = {{{"buffer", 0}, {"byteLength", 32}, {"byteStride", 8}},
                                 {{"buffer", 0}, {"byteOffset", 32}, {"byteLength", 12}}};
    EXPECT_NEAR(enclosed(read(scene)), -1.0 / 6, 1e-12);
}

TEST_F(Glb, ThatIsMalformedIsRefused) {
    const std::string good = Scene().bytes();
    EXPECT_EQ(wrong(good), "no error");
    EXPECT_THAT(wrong("glTF"), HasSubstr("not a binary glTF file"));
    EXPECT_THAT(wrong(good.substr(0, good.size() - 1)), HasSubstr("bytes, it has"));
    EXPECT_THAT(wrong("glTF" + word(1) + good.substr(8)), HasSubstr("version 1"));
    std::string longer = good;
    longer.replace(12, 4, word(0xfffffff0));
    EXPECT_THAT(wrong(longer), HasSubstr("a chunk should have 4294967280 bytes"));
    EXPECT_THAT(wrong(glb("{", "")), HasSubstr("not an object of JSON"));
    EXPECT_THAT(wrong(glb(std::string(4000, '['), "")), HasSubstr("deep"));
    using Change = std::function<void(Json&)>;
    const std::vector<std::pair<std::string, Change>> changes{
        {"accessor 0 has 5 entries", [](Json& j) { j["accessors"][0]["count"] = 5; }},
        {"accessor 0 has 4294967295 entries", [](Json& j) { j["accessors"][0]["count"] = 4294967295U; }},
        {"a whole number", [](Json& j) { j["accessors"][0]["count"] = 1e300; }},
        {"a whole number", [](Json& j) { j["accessors"][0]["byteOffset"] = -1; }},
        {"accessor 0 has 4 entries", [](Json& j) { j["accessors"][0]["byteOffset"] = 4; }},
        {"bufferView 1 has bytes to 73; the file has 72", [](Json& j) { j["bufferViews"][1]["byteLength"] = 25; }},
        {"bufferView 1 has bytes to", [](Json& j) { j["bufferViews"][1]["byteOffset"] = 4294967295U; }},
        {"\"byteStride\" is 8", [](Json& j) { j["bufferViews"][0]["byteStride"] = 8; }},
        {"names number 7 of the 2 accessors", [](Json& j) { j["meshes"][0]["primitives"][0]["indices"] = 7; }},
        {"has the corner 3; there are 3 points", [](Json& j) { j["accessors"][0]["count"] = 3; }},
        {"has 11 corners", [](Json& j) { j["accessors"][1]["count"] = 11; }},
        {"node 0 has the child 0, which is reached twice", [](Json& j) { j["nodes"][0]["children"] = {0}; }},
        {"reached twice",
         [](Json& j) {
             j["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
         }},
        {"reached twice",
         [](Json& j) {
             j["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
         }},
        {"the nodes are a cycle",
         [](Json& j) {
             j.erase("scenes");
             j["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
         }},
        {"the child 9, which is not there", [](Json& j) { j["nodes"][0]["children"] = {9}; }},
        {"\"matrix\" is not a list of 16 numbers",
         [](Json& j) {
             j["nodes"][0]["matrix"] = {1, 2};
         }},
        {"the type is \"VEC2\"", [](Json& j) { j["accessors"][0]["type"] = "VEC2"; }},
        {"\"componentType\" is 5130", [](Json& j) { j["accessors"][1]["componentType"] = 5130; }},
        {"corners are not whole numbers",
         [](Json& j) {
             j["accessors"][1] = {{"bufferView", 1}, {"componentType", 5126}, {"count", 6}, {"type", "SCALAR"}};
         }},
        {"sparse",
         [](Json& j) {
             j["accessors"][0]["sparse"] = {{"count", 1}};
         }},
        {"KHR_draco_mesh_compression",
         [](Json& j) {
             j["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
         }},
        {"EXT_meshopt_compression",
         [](Json& j) {
             j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}};
         }},
        {"buffer 0 is not in the file", [](Json& j) { j["buffers"][0]["uri"] = "a.bin"; }},
        {"skin", [](Json& j) { j["nodes"][0]["skin"] = 0; }},
        {"the version is", [](Json& j) { j["asset"]["version"] = "1.0"; }},
        {"the file has no \"asset\"", [](Json& j) { j.erase("asset"); }},
        {"\"nodes\" is not a list", [](Json& j) { j["nodes"] = 3; }},
    };
    for (const auto& [part, change] : changes) EXPECT_THAT(wrong(change), HasSubstr(part)) << part;
    // A small file whose copies would fill the memory.
    EXPECT_THAT(wrong([](Json& j) {
                    j["accessors"][1]["count"] = 12;
                    Json primitive = j["meshes"][0]["primitives"][0];
                    for (int k = 0; k < 1000; ++k) j["meshes"][0]["primitives"].push_back(primitive);
                    j.erase("scenes");
                    for (int k = 0; k < 600; ++k) j["nodes"].push_back({{"mesh", 0}});
                }),
                HasSubstr("more than 2000000 triangles"));
    // Each cut of the file is refused, and none crashes.
    for (std::size_t length = 0; length < good.size(); length += 7) EXPECT_NE(wrong(good.substr(0, length)), "no error");
}

}  // namespace glb_test
}  // namespace subvol
