// SPDX-License-Identifier: Apache-2.0
#include "study_scenes.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>
#include <tuple>
#include <utility>

#include "subvol/camera.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/several_errors.h"
#include "subvol/error.h"
#include "subvol/model.h"

namespace subvol::detail {

namespace fs = std::filesystem;

namespace {

std::vector<Key> input_keys() {
    using enum KeyKind;
    std::vector<std::string> models{"cell"};
    for (const ModelInfo& model : list_models()) models.push_back(model.name);
    return {{"model", Text, 0, 0, {}, models},
            {"file"},
            {"resolution", Whole, 2, 512},
            {"refine", Whole, 0, 4},
            {"field"},
            {"density"},
            {"crease_angle"},
            {"only"},
            {"warp"}};
}

const std::vector<Key>& light_keys() {
    static const std::vector<Key> kKeys{{"colors"}, {"opacity"}, {"opacity_unit", KeyKind::Number, 0, 1e12}};
    return kKeys;
}

bool is_plain(unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
}

std::string checked_name(std::string name, const std::string& path) {
    if (name.empty() || name.size() > 64 || !std::ranges::all_of(name, is_plain)) {
        refuse(path, "'" + shortened(name) + "' is not a valid name", "1 to 64 letters, digits, _ and -");
    }
    return name;
}

/// The name of an input file that has none: the file's, with other characters replaced.
std::string name_of_file(const fs::path& file) {
    std::string name = file.stem().string().substr(0, 64);
    for (char& c : name) {
        if (!is_plain(static_cast<unsigned char>(c))) c = '-';
    }
    return name.empty() ? "mesh" : name;
}

class SceneReader {
public:
    SceneReader(const Json& json, const fs::path& file, const std::string& root) : json_(json), file_(file), root_(root) {}

    [[nodiscard]] std::vector<StudyValues> inputs() const {
        return each("inputs", [&](const Json& item, const std::string& path, std::size_t, std::vector<StudyValues>& all) {
            const auto keys = input_keys();
            const std::vector<std::string> besides{"name", "given"};
            for (const StudyValues& read : read_values(item, keys, besides, path)) {
                if (read.contains("model") == read.contains("file")) refuse(path, "an input has either a model or a file");
                if (read.contains("file") && read.contains("resolution")) refuse(path, "a file has no resolution");
                if (read.contains("model") && read.contains("crease_angle"))
                    refuse(path, "crease_angle says how a file is read; this is a model");
                if (read.contains("field") && read.contains("density"))
                    refuse(path, "an input has either a field or a density");
                StudyValues values;
                for (const auto& [key, value] : read) values["input." + key] = value;
                const std::string name =
                    read.contains("model") ? as_text(read.at("model")) : name_of_file(as_text(read.at("file")));
                if (read.contains("file")) {
                    const std::string file = resolved(as_text(read.at("file")));
                    const std::string content = content_of(file, in(path, "file"));
                    if (content.empty()) refuse(in(path, "file"), "'" + printable(file) + "' cannot be read");
                    values["input.file"] = file;
                    values["input.content"] = content;
                }
                values["input"] = item.contains("name") ? name_of(item, path) : name;
                read_given(item, path, values);
                all.push_back(std::move(values));
                check_count(all.size(), path);
            }
        });
    }

    [[nodiscard]] std::vector<StudyValues> cameras() const {
        const auto read = [&](const Json& item, const std::string& path, std::size_t i, std::vector<StudyValues>& all) {
            std::string name = "camera" + std::to_string(i), camera;
            if (item.is_object()) {
                const std::vector<std::string> known{"name", "camera", "visible"};
                check_object(item, path, known);
                name = name_of(item, path);
                if (!item.contains("camera")) refuse(in(path, "camera"), "the camera is missing");
                camera = read_text(item["camera"], in(path, "camera"));
            } else {
                camera = read_text(item, path);
                if (camera.size() <= 4) name = camera;  // a side, such as +x
            }
            StudyValues values{{"view", name}, {"camera", camera}};
            if (item.is_object() && item.contains("visible")) {
                values["camera.visible"] = read_value(item["visible"], {"visible", KeyKind::Switch}, in(path, "visible"));
            }
            if (camera.ends_with(".json")) add_file(values, "camera", path);
            check_camera(as_text(values["camera"]), path);
            all.push_back(std::move(values));
        };
        std::vector<StudyValues> all = each("cameras", read);
        if (all.empty()) all.push_back({{"view", "iso"}, {"camera", "iso"}});
        return all;
    }

    /// Cases fit their cameras to their meshes; whether the text is a camera can be seen with any box.
    static void check_camera(const std::string& camera, const std::string& path) {
        try {
            std::ignore = parse_camera(camera, {{0, 0, 0}, {1, 1, 1}});
        } catch (const Error& error) {
            refuse(path, error.what());
        }
    }

    [[nodiscard]] std::vector<StudyValues> lights() const {
        const auto read_light = [&](const Json& item, const std::string& path, std::size_t, std::vector<StudyValues>& all) {
            if (item.is_string()) {
                const std::string colors = read_text(item, path);
                StudyValues values{{"tf", fs::path(colors).stem().string()}, {"tf.colors", colors}};
                add_file(values, "tf.colors", path);
                all.push_back(std::move(values));
                return;
            }
            const std::vector<std::string> besides{"name"};
            for (const StudyValues& read : read_values(item, light_keys(), besides, path)) {
                StudyValues values{{"tf", name_of(item, path)}};
                for (const auto& [key, value] : read) values["tf." + key] = value;
                add_file(values, "tf.colors", path);
                all.push_back(std::move(values));
                check_count(all.size(), path);
            }
        };
        std::vector<StudyValues> all = each("transfer_functions", read_light);
        if (all.empty()) all.push_back({{"tf", "viridis"}, {"tf.colors", "viridis"}});
        return all;
    }

    void add_file(StudyValues& values, const std::string& key, const std::string& path) const {
        if (!values.contains(key)) return;
        const std::string named = as_text(values[key]);
        const std::size_t end = named.find(".json");
        if (end == std::string::npos) return;
        const std::string file = resolved(named.substr(0, end + 5));
        const std::string content = content_of(file, path);
        if (content.empty()) refuse(path, "'" + printable(file) + "' cannot be read");
        values[key] = file + named.substr(end + 5);
        values[key + ".content"] = content;
    }

private:
    /// Reads a list. read(item, its path, its number, the values to which it adds its own)
    template <class Read>
    [[nodiscard]] std::vector<StudyValues> each(const char* key, const Read& read) const {
        Mistakes mistakes;
        std::vector<StudyValues> all;
        const Json& items = list_of(json_, root_, key);
        for (std::size_t i = 0; i < items.size(); ++i) mistakes.none_in([&] { read(items[i], at(in(root_, key), i), i, all); });
        mistakes.check();
        return all;
    }

    [[nodiscard]] std::string resolved(const std::string& name) const {
        const fs::path path(name);
        return path.is_absolute() ? name : (file_.parent_path() / path).lexically_normal().string();
    }

    const Json& json_;
    const fs::path& file_;
    const std::string& root_;
};

}  // namespace

StudyScenes read_scenes(const Json& json, const fs::path& file, const std::string& root) {
    const SceneReader reader(json, file, root);
    Mistakes mistakes;
    StudyScenes scenes;
    mistakes.none_in([&] { scenes.inputs = reader.inputs(); });
    mistakes.none_in([&] { scenes.cameras = reader.cameras(); });
    mistakes.none_in([&] { scenes.lights = reader.lights(); });
    mistakes.check();
    return scenes;
}

std::string content_of(const fs::path& file, const std::string& path) {
    std::error_code none;
    if (!fs::is_directory(file, none) && !not_regular(file).empty()) {
        refuse(path, "'" + printable(file.string()) + "' is not a regular file");
    }
    std::ifstream in(file, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    return in ? hash_text(bytes.str()) : "";
}

const Json& list_of(const Json& json, const std::string& root, const char* key) {
    static const Json kNone = Json::array();
    const auto found = json.find(key);
    if (found == json.end()) return kNone;
    if (!found->is_array()) refuse(in(root, key), must_be("a list", *found));
    if (found->empty()) refuse(in(root, key), "the list is empty");
    if (found->size() > kMaxStudyCases) refuse(in(root, key), "the list is too long");
    return *found;
}

std::string name_of(const Json& json, const std::string& path) {
    if (!json.contains("name")) refuse(in(path, "name"), "the name is missing");
    return checked_name(read_text(json["name"], in(path, "name")), in(path, "name"));
}

void read_given(const Json& json, const std::string& path, StudyValues& values) {
    const auto found = json.find("given");
    if (found == json.end()) return;
    if (!found->is_object()) refuse(in(path, "given"), must_be("an object", *found));
    for (const auto& [key, value] : found->items()) {
        const std::string place = in(in(path, "given"), key);
        if (!value.is_number() && !value.is_string()) refuse(place, must_be("a number or a string", value));
        values["given." + key] = value.is_number() ? StudyValue(value.get<double>()) : value.get<std::string>();
    }
}

void check_count(std::size_t count, const std::string& path) {
    if (count <= kMaxStudyCases) return;
    refuse(path, "there are too many cases", "at most " + std::to_string(kMaxStudyCases));
}

}  // namespace subvol::detail
