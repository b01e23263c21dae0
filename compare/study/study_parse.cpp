// SPDX-License-Identifier: Apache-2.0
// A study from its JSON: a list of cases, each a complete set of values by which it can be run alone.
//
//     inputs × cameras × lights × options of a method ─► cases of the method;  all methods ─► cases of the study
//
// An option that is a list multiplies the cases, and its key is in their names. Every case also has the size, metrics and
// reference of the study, and the content of the files that it refers to, so that its id, a hash of all values, changes when
// they do. Two equal cases are refused, and equal names of different cases get the id. Mistakes are collected, and all of them
// are said together with the place of each in the JSON; what depends on a wrong part is not checked. The number of cases is
// limited before a product is formed.
#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "built_in_studies.h"
#include "study_keys.h"
#include "study_scenes.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/several_errors.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/option.h"
#include "subvol/picture_metrics.h"

namespace subvol {

namespace fs = std::filesystem;

namespace detail {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 1 << 20;

const std::vector<std::string> kStudyKeys{
    "name",    "title",    "about",     "inputs",   "methods",  "cameras", "transfer_functions",
    "size",    "metrics",  "reference", "timed",    "pictures", "tables",  "plots",
    "demands", "headings", "seconds",   "measured", "exr"};

const std::vector<Key>& reference_keys() {
    static const std::vector<Key> kKeys{{"method", KeyKind::Text, 0, 0, std::string("dense"), {"dense", "exact"}},
                                        {"tolerance", KeyKind::Number, 0, 1, 1e-3},
                                        {"max_levels", KeyKind::Whole, 1, 8, 6.0},
                                        {"samples", KeyKind::Whole, 1, 16, 1.0}};
    return kKeys;
}

class Parser {
public:
    Parser(const Json& json, const fs::path& file, std::span<const PictureMethod> methods)
        : json_(json), file_(file), root_(file.string() + ": "), methods_(methods) {}

    Study study() {
        if (!json_.is_object()) refuse(root_, must_be("an object", json_));
        Study result;
        Mistakes mistakes;
        const bool all_known = mistakes.none_in([&] { check_object(json_, root_, kStudyKeys); });
        if (all_known || json_.contains("name")) mistakes.none_in([&] { result.name = name_of(json_, root_); });
        result.title = result.name;
        mistakes.none_in([&] {
            if (json_.contains("title")) result.title = read_text(json_["title"], in(root_, "title"));
        });
        mistakes.none_in([&] {
            if (json_.contains("about")) result.about = read_text(json_["about"], in(root_, "about"));
        });
        mistakes.none_in([&] { result.timed = flag("timed"); });
        mistakes.none_in([&] {
            constexpr double kMost = 1e7;
            if (!json_.contains("seconds")) return;
            result.seconds =
                std::get<double>(read_value(json_["seconds"], {"seconds", KeyKind::Number, 0, kMost}, in(root_, "seconds")));
        });
        mistakes.none_in([&] {
            if (!json_.contains("pictures") || !json_["pictures"].is_object()) result.pictures = flag("pictures");
        });
        const bool shown_well = mistakes.none_in([&] { read_presentation(json_, root_, result); });
        const bool complete = mistakes.none_in([&] { expand(result); });
        mistakes.none_in([&] {
            const auto unread = complete ? std::vector<StudyMethod>() : all_methods(methods_);
            check_presentation(result, root_, unread, !complete || !shown_well);
        });
        mistakes.check(file_.string());
        return result;
    }

private:
    [[nodiscard]] bool flag(const char* key) const {
        return json_.contains(key) && std::get<bool>(read_value(json_[key], {key, KeyKind::Switch}, in(root_, key)));
    }

    /// The values that all pictures share: their size, metrics and reference.
    StudyValues picture_values() const {
        StudyValues values;
        Mistakes mistakes;
        mistakes.none_in([&] {
            const auto size = json_.find("size");
            const Key edge{"size", KeyKind::Whole, 8, 8192};
            const std::string path = in(root_, "size");
            if (size != json_.end() && size->is_array()) {
                if (size->size() != 2) refuse(path, "a size is a width and a height");
                values["width"] = read_value((*size)[0], edge, at(path, 0));
                values["height"] = read_value((*size)[1], edge, at(path, 1));
            } else {
                values["width"] = values["height"] = size == json_.end() ? 512.0 : read_value(*size, edge, path);
            }
        });
        mistakes.none_in([&] {
            std::string metrics;
            const Json& names = list_of(json_, root_, "metrics");
            const Key metric{"metric", KeyKind::Text, 0, 0, {}, study_metrics()};
            for (std::size_t i = 0; i < names.size(); ++i) {
                mistakes.none_in([&] {
                    metrics +=
                        (metrics.empty() ? "" : ",") + as_text(read_value(names[i], metric, at(in(root_, "metrics"), i)));
                });
            }
            values["metrics"] = metrics.empty() ? "rmse,psnr" : metrics;
        });
        mistakes.none_in([&] {
            const Json none = Json::object();
            const auto reference = json_.find("reference");
            const std::string path = in(root_, "reference");
            const auto read = read_values(reference == json_.end() ? none : *reference, reference_keys(), {}, path);
            if (read.size() != 1) refuse(path, "there is only one reference: lists are not allowed");
            for (const auto& [key, value] : read.front()) values["reference." + key] = value;
        });
        mistakes.none_in([&] {
            if (flag("exr")) values["exr"] = true;
        });
        mistakes.check();
        return values;
    }

    void expand(Study& study) const {
        Mistakes mistakes;
        StudyScenes scenes;
        StudyValues common;
        mistakes.none_in([&] { scenes = read_scenes(json_, file_, root_); });
        mistakes.none_in([&] { common = picture_values(); });
        mistakes.none_in([&] {
            const Json& items = list_of(json_, root_, "methods");
            if (items.empty()) refuse(in(root_, "methods"), "the list is missing");
            for (std::size_t m = 0; m < items.size(); ++m)
                mistakes.none_in([&] { add_cases(items[m], at(in(root_, "methods"), m), scenes, common, study); });
        });
        mistakes.check();
        check_different(study);
    }

    /// The cases of one method.
    void add_cases(const Json& item, const std::string& path, const StudyScenes& scenes, const StudyValues& common,
                   Study& study) const {
        if (!item.is_object() || !item.contains("method")) refuse(path, "the method is missing");
        const StudyMethod method = find_method(read_text(item["method"], in(path, "method")), in(path, "method"), methods_);
        if (method.needs_mesh() && !json_.contains("inputs")) refuse(in(root_, "inputs"), "the list is missing");
        const auto swept = swept_keys(item);
        for (StudyValues& values : combinations(item, method, scenes, study.cases.size(), path)) {
            values["label"] = filled_in(as_text(values["label"]), values, in(path, "label"));
            values["study"] = study.name;
            if (method.needs_view()) values.insert(common.begin(), common.end());
            if (method.name == "file") add_file(values, in(path, "file"));
            if (method.name == "approximate") add_onto(values, path);
            check_exact(method, values, path);
            study.cases.push_back(named_case(std::move(values), swept));
        }
    }

    /// The picture that was made elsewhere, and its camera: a description beside it, else the numbers in its header.
    void add_file(StudyValues& values, const std::string& path) const {
        if (!values.contains("file")) refuse(path, "this key is missing", "a picture such as theirs/{input}_{view}_{tf}.exr");
        const fs::path named = filled_in(as_text(values.at("file")), values, path);
        const fs::path file = named.is_absolute() ? named : file_.parent_path() / named;
        const std::string in_header = camera_of_image(file);
        for (const auto& [key, one] : {std::pair("file", file), {"file.camera", fs::path(file).replace_extension(".json")}}) {
            values[key] = one.lexically_normal().string();
            values[std::string(key) + ".content"] = content_of(one, path);
            if (!as_text(values[std::string(key) + ".content"]).empty()) continue;
            if (one != file && !in_header.empty()) continue;
            refuse(
                path, "'" + printable(one.string()) + "' cannot be read",
                "the picture, and beside it a .json file with its camera: eye, target, up, fovy_deg or ortho_height; an .exr "
                "of `render` has it in its header");
        }
        if (as_text(values["file.camera.content"]).empty()) values["file.camera"] = in_header;
    }

    /// The control mesh of a file.
    void add_onto(StudyValues& values, const std::string& path) const {
        const bool named = values.contains("onto");
        if (named == values.contains("coarser")) refuse(path, "the control mesh is given by either 'coarser' or 'onto'");
        if (!named) return;
        const fs::path file = as_text(values.at("onto"));
        const std::string whole = (file.is_absolute() ? file : file_.parent_path() / file).lexically_normal().string();
        values["onto"] = whole;
        values["onto.content"] = content_of(whole, in(path, "onto"));
        if (as_text(values["onto.content"]).empty()) refuse(in(path, "onto"), "'" + printable(whole) + "' cannot be read");
    }

    /// Closed forms are those of generated models, with the field that they come with.
    void check_exact(const StudyMethod& method, const StudyValues& values, const std::string& path) const {
        const auto reference = values.find("reference.method");
        const bool exact_reference = reference != values.end() && as_text(reference->second) == "exact";
        if (method.name != "exact" && !exact_reference) return;
        const bool known = values.contains("input.model") && as_text(values.at("input.model")) != "cell";
        if (known && !values.contains("input.density") && !values.contains("input.field")) return;
        refuse(method.name == "exact" ? in(path, "method") : in(root_, "reference"),
               "the input '" + as_text(values.at("input")) + "' has no closed form", "models with their own density");
    }

    /// The cases of one method. already: how many cases there are before
    static std::vector<StudyValues> combinations(const Json& item, const StudyMethod& method, const StudyScenes& scenes,
                                                 std::size_t already, const std::string& path) {
        const std::vector<std::string> besides{"method", "label", "given"};
        StudyValues head{{"method", std::string(method.name)}, {"label", std::string(method.name)}};
        Mistakes mistakes;
        mistakes.none_in([&] {
            if (item.contains("label")) head["label"] = read_text(item["label"], in(path, "label"));
        });
        mistakes.none_in([&] { read_given(item, path, head); });
        const std::vector<StudyValues> nothing(1);
        std::vector<StudyValues> options;
        mistakes.none_in([&] { options = read_values(item, method.keys, besides, path); });
        mistakes.check();
        for (const StudyValues& values : options) check_needs(method, values, item, path);
        std::vector<StudyValues> all{head};
        const std::array<const std::vector<StudyValues>*, 4> factors{method.needs_mesh() ? &scenes.inputs : &nothing,
                                                                     method.needs_view() ? &scenes.cameras : &nothing,
                                                                     method.needs_view() ? &scenes.lights : &nothing, &options};
        for (const auto* factor : factors) {
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
    std::span<const PictureMethod> methods_;
};

}  // namespace
}  // namespace detail

Study parse_study(std::string_view text, const fs::path& file, std::span<const PictureMethod> methods) {
    detail::Json json;
    try {
        json = detail::Json::parse(detail::of_limited_depth(text, file.string()));
    } catch (const nlohmann::json::exception& error) {
        throw Error(ErrorCode::InvalidInput, "is not JSON: " + detail::parser_message(error.what()), file.string());
    }
    return detail::Parser(json, file, methods).study();
}

Study read_study(const fs::path& file, std::span<const PictureMethod> methods) {
    std::error_code error;
    const auto bytes = fs::file_size(file, error);
    if (error) throw Error(ErrorCode::Io, "cannot be read: " + error.message(), file.string());
    if (bytes > detail::kMaxFileBytes)
        throw Error(ErrorCode::InvalidInput, "is larger than a study may be (1 MiB)", file.string());
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) throw Error(ErrorCode::Io, "cannot be read", file.string());
    return parse_study(text.str(), file, methods);
}

std::vector<StudyInfo> list_studies() {
    std::vector<StudyInfo> all;
    for (const EmbeddedText& file : kTexts) {
        const auto json = detail::Json::parse(file.text);
        all.push_back({std::string(file.name), json.at("title").get<std::string>(), json.value("seconds", 0.0)});
    }
    return all;
}

std::string_view built_in_study_json(const std::string& name) {
    std::string known;
    std::vector<std::string> names;
    for (const EmbeddedText& file : kTexts) {
        if (file.name == name) return file.text;
        names.emplace_back(file.name);
        known += (known.empty() ? "" : ", ") + std::string(file.name);
    }
    throw Error(ErrorCode::InvalidInput,
                "there is no study '" + detail::shortened(name) + "'" + detail::did_you_mean(name, names), {}, known);
}

Study built_in_study(const std::string& name, std::span<const PictureMethod> methods) {
    return parse_study(built_in_study_json(name), name, methods);
}

}  // namespace subvol
