// SPDX-License-Identifier: Apache-2.0
// A .glb file is a head, a chunk of JSON and a chunk of bytes:
//
//     "glTF" 2 length │ length "JSON" {…} │ length "BIN\0" …
//
// In the JSON nodes name their children, a transform and a mesh; a mesh is made of primitives, whose corners and positions are
// accessors: numbers of a type in a view of the bytes. Nothing of that is believed: each number is compared with what is there
// before it is used.
#include "glb_triangles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>

#include "subvol/detail/json_depth.h"
#include "subvol/detail/number_type.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

using GlbJson = nlohmann::json;
using Mat4 = glm::dmat4;

constexpr std::size_t kGlbHead = 12, kChunkHead = 8;
constexpr std::uint64_t kMostOfFile = 0xFFFFFFFF;  // bytes: lengths are of 32 bits

/// The type of an accessor's numbers. largest: what a normalized one is divided by
struct GlbNumbers {
    std::uint64_t component;
    NumberType type;
    std::size_t bytes;
    double largest;
};
constexpr std::array<GlbNumbers, 6> kGlbNumbers{{{5120, NumberType::Int8, 1, 127},
                                                 {5121, NumberType::UInt8, 1, 255},
                                                 {5122, NumberType::Int16, 2, 32767},
                                                 {5123, NumberType::UInt16, 2, 65535},
                                                 {5125, NumberType::UInt32, 4, 1},
                                                 {5126, NumberType::Float32, 4, 1}}};

/// An accessor whose numbers all lie in the bytes. stride: from one entry to the next
struct GlbAccessor {
    std::string_view bytes;
    std::size_t count = 0, stride = 0;
    const GlbNumbers* numbers = nullptr;
    bool normalized = false;

    [[nodiscard]] std::string_view at(std::size_t entry, std::size_t k) const {
        return bytes.substr(entry * stride + k * numbers->bytes, numbers->bytes);
    }
    [[nodiscard]] double real(std::size_t entry, std::size_t k) const {
        constexpr auto kOrder = std::endian::little;
        if (numbers->type == NumberType::Float32) return real_from(at(entry, k), numbers->type, kOrder);
        const auto value = static_cast<double>(integer_from(at(entry, k), numbers->type, kOrder));
        return normalized ? std::max(value / numbers->largest, -1.0) : value;
    }
    [[nodiscard]] std::uint64_t corner(std::size_t entry) const {
        return static_cast<std::uint64_t>(integer_from(at(entry, 0), numbers->type, std::endian::little));
    }
};

class GlbReader {
public:
    GlbReader(std::string_view bytes, const std::string& name) : name_(name) { split(bytes); }

    std::vector<Vec3> read() {
        const GlbJson version = member(member(json_, "asset", "the file"), "version", "asset");
        if (!version.is_string() || !version.get_ref<const std::string&>().starts_with("2."))
            fail("asset: the version is " + version.dump(), "2.0");
        each_node([&](const GlbJson& node, const Mat4& transform, const std::string& where) {
            if (!node.contains("mesh")) return;
            if (node.contains("skin")) fail(where + " has a skin, which is not read", "a file without skins");
            refuse_extensions(node, {"EXT_mesh_gpu_instancing"}, where);
            const std::uint64_t number = whole(node, "mesh", where);
            const GlbJson& mesh = entry("meshes", number, where);
            const std::string of_mesh = "mesh " + std::to_string(number);
            const GlbJson& primitives = list(mesh, "primitives", of_mesh);
            for (std::size_t k = 0; k < primitives.size(); ++k)
                add_primitive(primitives[k], transform, of_mesh + ", primitive " + std::to_string(k));
        });
        return std::move(corners_);
    }

private:
    [[noreturn]] void fail(const std::string& what, const std::string& allowed = {}) const {
        throw Error(ErrorCode::InvalidInput, printable(what), name_, allowed);
    }

    [[nodiscard]] static std::uint32_t word_at(std::string_view bytes, std::size_t at) {
        return static_cast<std::uint32_t>(integer_from(bytes.substr(at, 4), NumberType::UInt32, std::endian::little));
    }

    /// Finds the chunks, and reads the JSON.
    void split(std::string_view bytes) {
        if (bytes.size() < kGlbHead || !bytes.starts_with("glTF"))
            fail("not a binary glTF file: it does not begin with \"glTF\"");
        if (word_at(bytes, 4) != 2) fail("glTF of version " + std::to_string(word_at(bytes, 4)), "version 2");
        if (word_at(bytes, 8) != bytes.size())
            fail("the file should have " + std::to_string(word_at(bytes, 8)) + " bytes, it has " +
                 std::to_string(bytes.size()));
        std::optional<std::string_view> json, data;
        for (std::size_t at = kGlbHead; at < bytes.size();) {
            if (bytes.size() - at < kChunkHead) fail("byte " + std::to_string(at) + ": a chunk is cut off");
            const std::size_t length = word_at(bytes, at), room = bytes.size() - at - kChunkHead;
            if (length > room)
                fail("byte " + std::to_string(at) + ": a chunk should have " + std::to_string(length) + " bytes, there are " +
                     std::to_string(room));
            const std::string_view type = bytes.substr(at + 4, 4), chunk = bytes.substr(at + kChunkHead, length);
            if (!json && type != "JSON") fail("the first chunk is not JSON");
            if (!json) {
                json = chunk;
            } else if (!data && type == std::string_view("BIN\0", 4)) {
                data = chunk;
            }
            at += kChunkHead + length;
        }
        if (!json) fail("there is no chunk of JSON");
        data_ = data.value_or("");
        json_ = GlbJson::parse(of_limited_depth(*json, name_), nullptr, false);
        if (!json_.is_object()) fail("the chunk of JSON is not an object of JSON");
    }

    [[nodiscard]] const GlbJson& member(const GlbJson& from, const char* key, const std::string& where) const {
        const auto found = from.is_object() ? from.find(key) : from.end();
        if (!from.is_object() || found == from.end()) fail(where + " has no \"" + key + "\"");
        return *found;
    }

    [[nodiscard]] const GlbJson& list(const GlbJson& from, const char* key, const std::string& where) const {
        const GlbJson& found = member(from, key, where);
        if (!found.is_array()) fail(where + ": \"" + key + "\" is not a list");
        return found;
    }

    [[nodiscard]] const GlbJson& entry(const char* key, std::uint64_t number, const std::string& where) const {
        const GlbJson& all = list(json_, key, "the file");
        if (number >= all.size())
            fail(where + " names number " + std::to_string(number) + " of the " + std::to_string(all.size()) + " " + key);
        return all[static_cast<std::size_t>(number)];
    }

    /// A whole number that a file of this size may have.
    [[nodiscard]] std::uint64_t whole(const GlbJson& value, const std::string& where) const {
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() > kMostOfFile)
            fail(where + " is " + value.dump(-1, ' ', false, GlbJson::error_handler_t::replace).substr(0, 40),
                 "a whole number from 0");
        return value.get<std::uint64_t>();
    }
    [[nodiscard]] std::uint64_t whole(const GlbJson& from, const char* key, const std::string& where,
                                      std::optional<std::uint64_t> otherwise = {}) const {
        if (otherwise && from.is_object() && !from.contains(key)) return *otherwise;
        return whole(member(from, key, where), where + ": \"" + key + "\"");
    }

    void refuse_extensions(const GlbJson& from, std::initializer_list<const char*> names, const std::string& where) const {
        const auto extensions = from.find("extensions");
        if (extensions == from.end() || !extensions->is_object()) return;
        for (const char* name : names) {
            if (extensions->contains(name))
                fail(where + " needs " + name + ", which is not read", "a file exported without it");
        }
    }

    [[nodiscard]] std::vector<double> reals(const GlbJson& from, const char* key, std::size_t count,
                                            const std::string& where) const {
        const GlbJson& values = list(from, key, where);
        std::vector<double> found;
        for (const GlbJson& value : values) {
            if (found.size() < count && value.is_number()) found.push_back(value.get<double>());
        }
        if (found.size() != count || values.size() != count)
            fail(where + ": \"" + key + "\" is not a list of " + std::to_string(count) + " numbers");
        return found;
    }

    [[nodiscard]] Mat4 transform_of(const GlbJson& node, const std::string& where) const {
        Mat4 transform(1.0);
        if (node.contains("matrix")) {
            const std::vector<double> m = reals(node, "matrix", 16, where);
            for (int k = 0; k < 16; ++k) transform[k / 4][k % 4] = m[static_cast<std::size_t>(k)];
            return transform;
        }
        if (node.contains("rotation")) {
            const std::vector<double> q = reals(node, "rotation", 4, where);
            const double x = q[0], y = q[1], z = q[2], w = q[3];
            transform[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0};
            transform[1] = {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0};
            transform[2] = {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0};
        }
        if (node.contains("scale")) {
            const std::vector<double> s = reals(node, "scale", 3, where);
            for (int k = 0; k < 3; ++k) transform[k] *= s[static_cast<std::size_t>(k)];
        }
        if (node.contains("translation")) {
            const std::vector<double> t = reals(node, "translation", 3, where);
            transform[3] = {t[0], t[1], t[2], 1};
        }
        return transform;
    }

    /// Where the nodes begin: those of the scene, or all that are no child of another one.
    [[nodiscard]] std::vector<std::size_t> roots(const GlbJson& nodes) const {
        std::vector<std::size_t> found;
        const auto add = [&](const GlbJson& numbers, const std::string& where, const auto& take) {
            for (const GlbJson& one : numbers) {
                const std::uint64_t number = whole(one, where);
                if (number >= nodes.size())
                    fail(where + " is " + std::to_string(number) + "; there are " + std::to_string(nodes.size()) + " nodes");
                take(static_cast<std::size_t>(number));
            }
        };
        if (json_.contains("scenes") && !list(json_, "scenes", "the file").empty()) {
            const std::uint64_t number = whole(json_, "scene", "the file", 0);
            const GlbJson& scene = entry("scenes", number, "\"scene\"");
            if (scene.is_object() && scene.contains("nodes"))
                add(list(scene, "nodes", "the scene"), "a node of the scene", [&](std::size_t node) { found.push_back(node); });
            return found;
        }
        std::vector<std::uint8_t> is_child(nodes.size(), 0);
        for (const GlbJson& node : nodes) {
            if (node.is_object() && node.contains("children"))
                add(list(node, "children", "a node"), "a child", [&](std::size_t child) { is_child[child] = 1; });
        }
        for (std::size_t node = 0; node < nodes.size(); ++node) {
            if (is_child[node] == 0) found.push_back(node);
        }
        if (found.empty() && !nodes.empty()) fail("the nodes are a cycle: each is the child of another one");
        return found;
    }

    /// Calls visit(node, transform, where) for the nodes of the scene. A tree: each has one parent at most.
    template <class Visit>
    void each_node(const Visit& visit) {
        if (!json_.contains("nodes")) return;
        const GlbJson& nodes = list(json_, "nodes", "the file");
        std::vector<std::pair<std::size_t, Mat4>> waiting;
        for (const std::size_t root : roots(nodes)) waiting.emplace_back(root, Mat4(1.0));
        std::ranges::reverse(waiting);
        std::vector<std::uint8_t> met(nodes.size(), 0);
        while (!waiting.empty()) {
            const auto [number, above] = waiting.back();
            waiting.pop_back();
            const std::string where = "node " + std::to_string(number);
            if (std::exchange(met[number], std::uint8_t{1}) != 0) fail(where + " is reached twice", "nodes that are a tree");
            const GlbJson& node = nodes[number];
            if (!node.is_object()) fail(where + " is not an object");
            const Mat4 transform = above * transform_of(node, where);
            visit(node, transform, where);
            if (!node.contains("children")) continue;
            const GlbJson& children = list(node, "children", where);
            for (std::size_t k = children.size(); k-- > 0;) {
                const std::uint64_t child = whole(children[k], where + ": a child");
                if (child >= nodes.size() || met[child] != 0)
                    fail(where + " has the child " + std::to_string(child) +
                             (child < nodes.size() ? ", which is reached twice" : ", which is not there"),
                         "nodes that are a tree");
                waiting.emplace_back(static_cast<std::size_t>(child), transform);
            }
        }
    }

    [[nodiscard]] GlbAccessor accessor(std::uint64_t number, const char* type, std::size_t components,
                                       const std::string& of) const {
        const GlbJson& json = entry("accessors", number, of);
        const std::string where = "accessor " + std::to_string(number);
        if (!json.is_object()) fail(where + " is not an object");
        if (json.contains("sparse")) fail(where + " is sparse, which is not read", "a file exported without sparse accessors");
        const GlbJson& named = member(json, "type", where);
        if (named != type) fail(where + ": the type is " + named.dump().substr(0, 40) + ", of " + of, type);
        GlbAccessor found;
        const std::uint64_t component = whole(json, "componentType", where);
        for (const GlbNumbers& numbers : kGlbNumbers) {
            if (numbers.component == component) found.numbers = &numbers;
        }
        if (found.numbers == nullptr) fail(where + ": \"componentType\" is " + std::to_string(component), "5120 to 5126");
        found.normalized = json.contains("normalized") && json["normalized"] == true;
        const std::uint64_t view_number = whole(json, "bufferView", where);
        const GlbJson& view = entry("bufferViews", view_number, where);
        const std::string of_view = "bufferView " + std::to_string(view_number);
        if (!view.is_object()) fail(of_view + " is not an object");
        refuse_extensions(view, {"EXT_meshopt_compression", "KHR_meshopt_compression"}, of_view);
        const std::uint64_t buffer = whole(view, "buffer", of_view);
        const GlbJson& of_buffer = entry("buffers", buffer, of_view);
        if (buffer != 0 || !of_buffer.is_object() || of_buffer.contains("uri"))
            fail("buffer " + std::to_string(buffer) + " is not in the file", "a .glb file that contains all its data");
        const std::uint64_t begin = whole(view, "byteOffset", of_view, 0), length = whole(view, "byteLength", of_view);
        if (begin > data_.size() || length > data_.size() - begin)
            fail(of_view + " has bytes to " + std::to_string(begin + length) + "; the file has " +
                 std::to_string(data_.size()));
        const std::size_t entry_bytes = components * found.numbers->bytes;
        const std::uint64_t stride = whole(view, "byteStride", of_view, entry_bytes);
        const std::uint64_t offset = whole(json, "byteOffset", where, 0), count = whole(json, "count", where);
        if (stride < entry_bytes)
            fail(of_view + ": \"byteStride\" is " + std::to_string(stride), "the size of an entry or more");
        // Of 32 bits each: their product fits into 64.
        const std::uint64_t needed = count == 0 ? 0 : (count - 1) * stride + entry_bytes;
        if (offset > length || needed > length - offset)
            fail(where + " has " + std::to_string(count) + " entries, beyond the " + std::to_string(length) + " bytes of " +
                 of_view);
        found.bytes = data_.substr(static_cast<std::size_t>(begin + offset), static_cast<std::size_t>(needed));
        found.count = static_cast<std::size_t>(count);
        found.stride = static_cast<std::size_t>(stride);
        return found;
    }

    void add_primitive(const GlbJson& primitive, const Mat4& transform, const std::string& where) {
        enum Mode : std::uint64_t { Triangles = 4, Strip = 5, Fan = 6 };
        if (!primitive.is_object()) fail(where + " is not an object");
        refuse_extensions(primitive, {"KHR_draco_mesh_compression"}, where);
        const std::uint64_t mode = whole(primitive, "mode", where, Triangles);
        if (mode > Fan) fail(where + ": \"mode\" is " + std::to_string(mode), "0 to 6");
        if (mode < Triangles) return;  // points or lines
        const GlbJson& attributes = member(primitive, "attributes", where);
        const GlbAccessor positions = accessor(whole(attributes, "POSITION", where), "VEC3", 3, where);
        std::optional<GlbAccessor> indices;
        if (primitive.contains("indices")) indices = accessor(whole(primitive, "indices", where), "SCALAR", 1, where);
        if (indices && indices->numbers->type != NumberType::UInt8 && indices->numbers->type != NumberType::UInt16 &&
            indices->numbers->type != NumberType::UInt32)
            fail(where + ": corners are not whole numbers from 0");
        const std::size_t corners = indices ? indices->count : positions.count;
        const auto point = [&](std::size_t k) {
            const std::uint64_t number = indices ? indices->corner(k) : k;
            if (number >= positions.count)
                fail(where + " has the corner " + std::to_string(number) + "; there are " + std::to_string(positions.count) +
                     " points");
            const auto p = static_cast<std::size_t>(number);
            return Vec3(transform * glm::dvec4(positions.real(p, 0), positions.real(p, 1), positions.real(p, 2), 1.0));
        };
        if (mode == Triangles && corners % 3 != 0)
            fail(where + " has " + std::to_string(corners) + " corners", "three for each triangle");
        const std::size_t triangles = mode == Triangles ? corners / 3 : corners < 3 ? 0 : corners - 2;
        expect_room(triangles);
        const bool mirrored = glm::determinant(Mat3(transform)) < 0;
        for (std::size_t t = 0; t < triangles; ++t) {
            std::array<std::size_t, 3> of{3 * t, 3 * t + 1, 3 * t + 2};
            if (mode == Strip) of = {t, t + 1 + t % 2, t + 2 - t % 2};  // every other one is turned
            if (mode == Fan) of = {0, t + 1, t + 2};
            if (mirrored) std::swap(of[1], of[2]);
            for (const std::size_t k : of) corners_.push_back(point(k));
        }
    }

    /// One mesh may stand at many nodes, so the size of the file alone does not bound the triangles.
    void expect_room(std::size_t triangles) const {
        constexpr std::size_t kAlways = 2'000'000;
        const std::size_t most = std::max(kAlways, data_.size());
        if (triangles > most - corners_.size() / 3)
            fail("its nodes have more than " + std::to_string(most) + " triangles together", "fewer copies of its meshes");
    }

    std::string name_;
    std::string_view data_;
    GlbJson json_;
    std::vector<Vec3> corners_;
};

}  // namespace

std::vector<Vec3> read_glb_triangles(std::string_view bytes, const std::string& name) {
    return GlbReader(bytes, name).read();
}

}  // namespace subvol::detail
