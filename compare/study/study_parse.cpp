// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "study_keys.h"
#include "subvol/camera.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/model.h"

namespace subvol {

namespace fs = std::filesystem;

namespace detail {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 1 << 20;

const std::vector<std::string> kStudyKeys{
    "name",      "title", "about",    "inputs", "methods", "cameras", "transfer_functions", "size",   "metrics",
    "reference", "timed", "pictures", "tables", "plots",   "demands", "headings",           "seconds"};

const std::vector<std::string> kMetrics{"mse",           "rmse",      "mae",          "max",           "psnr",
                                        "ssim",          "flip",      "flip_hdr",     "psnr_interior", "psnr_edge",
                                        "flip_interior", "flip_edge", "optical_depth"};

std::vector<Key> input_keys() {
    using enum KeyKind;
    std::vector<std::string> models{"cell"};
    for (const ModelInfo& model : list_models()) models.push_back(model.name);
    return {{"model", Text, 0, 0, {}, models}, {"file"},  {"resolution", Whole, 2, 512},
            {"refine", Whole, 0, 4},           {"field"}, {"density"}};
}

const std::vector<Key>& light_keys() {
    static const std::vector<Key> kKeys{{"colors"}, {"opacity"}, {"opacity_unit", KeyKind::Number, 0, 1e12}};
    return kKeys;
}

const std::vector<Key>& reference_keys() {
    static const std::vector<Key> kKeys{{"method", KeyKind::Text, 0, 0, std::string("dense"), {"dense"}},
                                        {"tolerance", KeyKind::Number, 0, 1, 1e-3},
                                        {"max_levels", KeyKind::Whole, 1, 8, 6.0},
                                        {"samples", KeyKind::Whole, 1, 16, 1.0}};
    return kKeys;
}

/// A hash of a file that a case depends on, as a part of the case's values: a changed file is another case.
std::string content_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    return in ? hash_text(bytes.str()) : "";
}

class Parser {
public:
    Parser(const Json& json, const fs::path& file) : json_(json), file_(file), root_(file.string() + ": ") {}

    Study study() {
        check_object(json_, root_, kStudyKeys);
        Study result;
        result.name = name_of(json_, root_);
        result.title = json_.contains("title") ? read_text(json_["title"], in(root_, "title")) : result.name;
        if (json_.contains("about")) result.about = read_text(json_["about"], in(root_, "about"));
        result.timed = flag("timed");
        if (json_.contains("seconds")) {
            constexpr double kMost = 1e7;
            result.seconds =
                std::get<double>(read_value(json_["seconds"], {"seconds", KeyKind::Number, 0, kMost}, in(root_, "seconds")));
        }
        if (!json_.contains("pictures") || !json_["pictures"].is_object()) result.pictures = flag("pictures");
        read_presentation(json_, root_, result);
        expand(result);
        return result;
    }

private:
    [[nodiscard]] bool flag(const char* key) const {
        return json_.contains(key) && std::get<bool>(read_value(json_[key], {key, KeyKind::Switch}, in(root_, key)));
    }

    /// Names become parts of file names.
    [[nodiscard]] static std::string name_of(const Json& json, const std::string& path) {
        if (!json.contains("name")) refuse(in(path, "name"), "the name is missing");
        return checked_name(read_text(json["name"], in(path, "name")), in(path, "name"));
    }

    /// The name of an input file that has none: the file's, with other characters replaced.
    static std::string name_of_file(const fs::path& file) {
        std::string name = file.stem().string().substr(0, 64);
        for (char& c : name) {
            if (!is_plain(static_cast<unsigned char>(c))) c = '-';
        }
        return name.empty() ? "mesh" : name;
    }

    static bool is_plain(unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; }

    static std::string checked_name(std::string name, const std::string& path) {
        if (name.empty() || name.size() > 64 || !std::ranges::all_of(name, is_plain)) {
            refuse(path, "'" + shortened(name) + "' is not a valid name", "1 to 64 letters, digits, _ and -");
        }
        return name;
    }

    [[nodiscard]] const Json& list(const char* key) const {
        static const Json kNone = Json::array();
        const auto found = json_.find(key);
        if (found == json_.end()) return kNone;
        if (!found->is_array()) refuse(in(root_, key), must_be("a list", *found));
        if (found->empty()) refuse(in(root_, key), "the list is empty");
        if (found->size() > kMaxStudyCases) refuse(in(root_, key), "the list is too long");
        return *found;
    }

    [[nodiscard]] std::string resolved(const std::string& name) const {
        const fs::path path(name);
        return path.is_absolute() ? name : (file_.parent_path() / path).lexically_normal().string();
    }

    /// Numbers and texts that are known from elsewhere and shown beside the results.
    static void read_given(const Json& json, const std::string& path, StudyValues& values) {
        const auto found = json.find("given");
        if (found == json.end()) return;
        if (!found->is_object()) refuse(in(path, "given"), must_be("an object", *found));
        for (const auto& [key, value] : found->items()) {
            const std::string place = in(in(path, "given"), key);
            if (!value.is_number() && !value.is_string()) refuse(place, must_be("a number or a string", value));
            values["given." + key] = value.is_number() ? StudyValue(value.get<double>()) : value.get<std::string>();
        }
    }

    std::vector<StudyValues> inputs() const {
        std::vector<StudyValues> all;
        const Json& items = list("inputs");
        for (std::size_t i = 0; i < items.size(); ++i) {
            const std::string path = at(in(root_, "inputs"), i);
            const auto keys = input_keys();
            const std::vector<std::string> besides{"name", "given"};
            for (const StudyValues& read : read_values(items[i], keys, besides, path)) {
                if (read.contains("model") == read.contains("file")) refuse(path, "an input has either a model or a file");
                if (read.contains("file") && read.contains("resolution")) refuse(path, "a file has no resolution");
                if (read.contains("field") && read.contains("density"))
                    refuse(path, "an input has either a field or a density");
                StudyValues values;
                for (const auto& [key, value] : read) values["input." + key] = value;
                const std::string name =
                    read.contains("model") ? as_text(read.at("model")) : name_of_file(as_text(read.at("file")));
                if (read.contains("file")) {
                    const std::string file = resolved(as_text(read.at("file")));
                    const std::string content = content_of(file);
                    if (content.empty()) refuse(in(path, "file"), "'" + printable(file) + "' cannot be read");
                    values["input.file"] = file;
                    values["input.content"] = content;
                }
                values["input"] = items[i].contains("name") ? name_of(items[i], path) : name;
                read_given(items[i], path, values);
                all.push_back(std::move(values));
                check_count(all.size(), path);
            }
        }
        return all;
    }

    std::vector<StudyValues> cameras() const {
        std::vector<StudyValues> all;
        const Json& items = list("cameras");
        for (std::size_t i = 0; i < items.size(); ++i) {
            const std::string path = at(in(root_, "cameras"), i);
            std::string name = "camera" + std::to_string(i), camera;
            if (items[i].is_object()) {
                const std::vector<std::string> known{"name", "camera", "visible"};
                check_object(items[i], path, known);
                name = name_of(items[i], path);
                if (!items[i].contains("camera")) refuse(in(path, "camera"), "the camera is missing");
                camera = read_text(items[i]["camera"], in(path, "camera"));
            } else {
                camera = read_text(items[i], path);
                if (camera.size() <= 4) name = camera;  // a side, such as +x
            }
            StudyValues values{{"view", name}, {"camera", camera}};
            if (items[i].is_object() && items[i].contains("visible")) {
                values["camera.visible"] = read_value(items[i]["visible"], {"visible", KeyKind::Switch}, in(path, "visible"));
            }
            if (camera.ends_with(".json")) add_file(values, "camera", path);
            check_camera(as_text(values["camera"]), path);
            all.push_back(std::move(values));
        }
        if (all.empty()) all.push_back({{"view", "iso"}, {"camera", "iso"}});
        return all;
    }

    /// Cases fit their cameras to their meshes; whether the text is a camera can be seen with any box.
    static void check_camera(const std::string& camera, const std::string& path) {
        try {
            static_cast<void>(parse_camera(camera, {{0, 0, 0}, {1, 1, 1}}));
        } catch (const Error& error) {
            refuse(path, error.what());
        }
    }

    std::vector<StudyValues> lights() const {
        std::vector<StudyValues> all;
        const Json& items = list("transfer_functions");
        for (std::size_t i = 0; i < items.size(); ++i) {
            const std::string path = at(in(root_, "transfer_functions"), i);
            if (items[i].is_string()) {
                const std::string colors = read_text(items[i], path);
                StudyValues values{{"tf", fs::path(colors).stem().string()}, {"tf.colors", colors}};
                add_file(values, "tf.colors", path);
                all.push_back(std::move(values));
                continue;
            }
            const std::vector<std::string> besides{"name"};
            for (const StudyValues& read : read_values(items[i], light_keys(), besides, path)) {
                StudyValues values{{"tf", name_of(items[i], path)}};
                for (const auto& [key, value] : read) values["tf." + key] = value;
                add_file(values, "tf.colors", path);
                all.push_back(std::move(values));
                check_count(all.size(), path);
            }
        }
        if (all.empty()) all.push_back({{"tf", "viridis"}, {"tf.colors", "viridis"}});
        return all;
    }

    void add_file(StudyValues& values, const std::string& key, const std::string& path) const {
        if (!values.contains(key)) return;
        const std::string named = as_text(values[key]);
        const std::size_t end = named.find(".json");
        if (end == std::string::npos) return;
        const std::string file = resolved(named.substr(0, end + 5));
        const std::string content = content_of(file);
        if (content.empty()) refuse(path, "'" + printable(file) + "' cannot be read");
        values[key] = file + named.substr(end + 5);
        values[key + ".content"] = content;
    }

    /// The values that all pictures share: their size, metrics and reference.
    StudyValues picture_values() const {
        StudyValues values;
        const auto size = json_.find("size");
        const Key edge{"size", KeyKind::Whole, 8, 8192};
        if (size != json_.end() && size->is_array()) {
            const std::string path = in(root_, "size");
            if (size->size() != 2) refuse(path, "a size is a width and a height");
            values["width"] = read_value((*size)[0], edge, at(path, 0));
            values["height"] = read_value((*size)[1], edge, at(path, 1));
        } else {
            values["width"] = values["height"] = size == json_.end() ? 512.0 : read_value(*size, edge, in(root_, "size"));
        }
        std::string metrics;
        const Json& names = list("metrics");
        for (std::size_t i = 0; i < names.size(); ++i) {
            const Key metric{"metric", KeyKind::Text, 0, 0, {}, kMetrics};
            metrics += (metrics.empty() ? "" : ",") + as_text(read_value(names[i], metric, at(in(root_, "metrics"), i)));
        }
        values["metrics"] = metrics.empty() ? "rmse,psnr" : metrics;
        const Json none = Json::object();
        const auto reference = json_.find("reference");
        const std::string path = in(root_, "reference");
        const auto read = read_values(reference == json_.end() ? none : *reference, reference_keys(), {}, path);
        if (read.size() != 1) refuse(path, "there is only one reference: lists are not allowed");
        for (const auto& [key, value] : read.front()) values["reference." + key] = value;
        return values;
    }

    void expand(Study& study) const {
        const Scenes scenes{inputs(), cameras(), lights()};
        const StudyValues common = picture_values();
        const Json& items = list("methods");
        if (items.empty()) refuse(in(root_, "methods"), "the list is missing");
        for (std::size_t m = 0; m < items.size(); ++m) {
            const std::string path = at(in(root_, "methods"), m);
            if (!items[m].is_object() || !items[m].contains("method")) refuse(path, "the method is missing");
            const StudyMethod& method = find_method(read_text(items[m]["method"], in(path, "method")), in(path, "method"));
            if (method.needs_mesh() && scenes.inputs.empty()) refuse(in(root_, "inputs"), "the list is missing");
            const auto swept = swept_keys(items[m]);
            for (StudyValues& values : combinations(items[m], method, scenes, study.cases.size(), path)) {
                values["label"] = filled_in(as_text(values["label"]), values, in(path, "label"));
                values["study"] = study.name;
                if (method.needs_view()) values.insert(common.begin(), common.end());
                study.cases.push_back(named_case(std::move(values), swept));
            }
        }
        check_different(study);
    }

    /// What methods are applied to.
    struct Scenes {
        std::vector<StudyValues> inputs, cameras, lights;
    };

    /// The cases of one method. already: how many cases there are before
    static std::vector<StudyValues> combinations(const Json& item, const StudyMethod& method, const Scenes& scenes,
                                                 std::size_t already, const std::string& path) {
        const std::vector<std::string> besides{"method", "label", "given"};
        StudyValues head{{"method", std::string(method.name)}, {"label", std::string(method.name)}};
        if (item.contains("label")) head["label"] = read_text(item["label"], in(path, "label"));
        read_given(item, path, head);
        const std::vector<StudyValues> nothing(1), options = read_values(item, method.keys, besides, path);
        std::vector<StudyValues> all{head};
        for (const auto* factor :
             {method.needs_mesh() ? &scenes.inputs : &nothing, method.needs_view() ? &scenes.cameras : &nothing,
              method.needs_view() ? &scenes.lights : &nothing, &options}) {
            check_count(already + all.size() * factor->size(), path);  // each is at most kMaxStudyCases: no overflow
            std::vector<StudyValues> product;
            for (const StudyValues& values : all) {
                for (const StudyValues& more : *factor) product.emplace_back(values).insert(more.begin(), more.end());
            }
            all = std::move(product);
        }
        return all;
    }

    /// A label with each {key} replaced by the case's value of that key.
    static std::string filled_in(const std::string& label, const StudyValues& values, const std::string& path) {
        std::string done;
        std::size_t from = 0;
        for (std::size_t open = label.find('{'); open != std::string::npos; open = label.find('{', from)) {
            const std::size_t close = label.find('}', open);
            const std::string key = close == std::string::npos ? "" : label.substr(open + 1, close - open - 1);
            const auto value = values.find(key);
            if (value == values.end())
                refuse(path, "there is no value named '" + shortened(key) + "'", "{KEY} of an option of the method");
            done += label.substr(from, open - from) + as_text(value->second);
            from = close + 1;
        }
        return done + label.substr(from);
    }

    static void check_count(std::size_t count, const std::string& path) {
        if (count <= kMaxStudyCases) return;
        refuse(path, "there are too many cases", "at most " + std::to_string(kMaxStudyCases));
    }

    static std::vector<std::string> swept_keys(const Json& method) {
        std::vector<std::string> keys;
        for (const auto& [key, value] : method.items()) {
            if (value.is_array()) keys.push_back(key);
        }
        return keys;
    }

    static StudyCase named_case(StudyValues values, const std::vector<std::string>& swept) {
        StudyCase made{.id = {}, .name = {}, .values = std::move(values)};
        made.id = case_id(made.values);
        for (const char* key : {"input", "input.resolution", "input.refine", "view", "tf", "label"}) {
            if (made.has(key)) made.name += (made.name.empty() ? "" : "_") + as_text(made.values[key]);
        }
        for (const std::string& key : swept) made.name += "_" + key + "-" + as_text(made.values[key]);
        for (char& c : made.name) {
            const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.' || c == '+';
            if (!plain) c = '-';
        }
        if (made.name.size() > 120) made.name = made.name.substr(0, 100) + "_" + made.id;
        return made;
    }

    /// Refuses equal cases; makes the names of different cases unique.
    void check_different(Study& study) const {
        std::map<std::string, std::size_t> ids, names;
        for (std::size_t i = 0; i < study.cases.size(); ++i) {
            const auto [other, fresh] = ids.emplace(study.cases[i].id, i);
            if (!fresh) {
                refuse(in(root_, "methods"),
                       "the cases '" + study.cases[other->second].name + "' and '" + study.cases[i].name + "' are the same");
            }
            if (++names[study.cases[i].name] > 1) study.cases[i].name += "_" + study.cases[i].id;
        }
    }

    const Json& json_;
    fs::path file_;
    std::string root_;
};

}  // namespace
}  // namespace detail

Study parse_study(std::string_view text, const fs::path& file) {
    detail::Json json;
    try {
        json = detail::Json::parse(text);
    } catch (const nlohmann::json::exception& error) {
        throw Error(ErrorCode::InvalidInput, "is not JSON: " + detail::parser_message(error.what()), file.string());
    }
    return detail::Parser(json, file).study();
}

Study read_study(const fs::path& file) {
    std::error_code error;
    const auto bytes = fs::file_size(file, error);
    if (error) throw Error(ErrorCode::Io, "cannot be read: " + error.message(), file.string());
    if (bytes > detail::kMaxFileBytes)
        throw Error(ErrorCode::InvalidInput, "is larger than a study may be (1 MiB)", file.string());
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) throw Error(ErrorCode::Io, "cannot be read", file.string());
    return parse_study(text.str(), file);
}

}  // namespace subvol
