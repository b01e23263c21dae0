// SPDX-License-Identifier: Apache-2.0
#include "study_keys.h"

namespace subvol::detail {

namespace {

/// A text, or a list of texts.
std::vector<std::string> texts(const Json& json, const char* key, const std::string& path, bool needed) {
    const auto found = json.find(key);
    const std::string place = in(path, key);
    if (found == json.end()) {
        if (needed) refuse(place, "this key is missing");
        return {};
    }
    if (!found->is_array()) return {read_text(*found, place)};
    if (found->empty()) refuse(place, "the list is empty");
    std::vector<std::string> all;
    for (std::size_t i = 0; i < found->size(); ++i) all.push_back(read_text((*found)[i], at(place, i)));
    return all;
}

std::string text_or(const Json& json, const char* key, const std::string& path, const std::string& otherwise = {}) {
    return json.contains(key) ? read_text(json[key], in(path, key)) : otherwise;
}

bool flag_or(const Json& json, const char* key, const std::string& path, bool otherwise) {
    return json.contains(key) ? std::get<bool>(read_value(json[key], {key, KeyKind::Switch}, in(path, key))) : otherwise;
}

std::map<std::string, std::string> words(const Json& json, const char* key, const std::string& path) {
    std::map<std::string, std::string> all;
    const auto found = json.find(key);
    if (found == json.end()) return all;
    const std::string place = in(path, key);
    if (!found->is_object()) refuse(place, must_be("an object", *found));
    for (const auto& [name, value] : found->items()) {
        all[name] = value.is_number()    ? as_text(value.get<double>())
                    : value.is_boolean() ? as_text(value.get<bool>())
                                         : read_text(value, in(place, name));
    }
    return all;
}

const Json& optional_list(const Json& json, const char* key, const std::string& path) {
    static const Json kNone = Json::array();
    if (!json.contains(key)) return kNone;
    if (!json[key].is_array()) refuse(in(path, key), must_be("a list", json[key]));
    if (json[key].empty()) refuse(in(path, key), "the list is empty");
    return json[key];
}

std::map<std::string, std::string> with_common(std::map<std::string, std::string> own,
                                               const std::map<std::string, std::string>& common) {
    own.insert(common.begin(), common.end());
    return own;
}

}  // namespace

void read_presentation(const Json& json, const std::string& root, Study& study) {
    const auto common = words(json, "headings", root);
    if (json.contains("pictures") && json["pictures"].is_object()) {
        study.pictures = true;
        study.pictures_where = words(json, "pictures", root);
    }
    study.measured = texts(json, "measured", root, false);
    const Json& tables = optional_list(json, "tables", root);
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const std::string path = at(in(root, "tables"), i);
        const std::vector<std::string> known{"title",  "caption", "rows",     "columns", "across",
                                             "values", "average", "headings", "where",   "digits"};
        check_object(tables[i], path, known);
        StudyTableSpec table{.title = text_or(tables[i], "title", path, study.title),
                             .caption = text_or(tables[i], "caption", path),
                             .rows = texts(tables[i], "rows", path, true),
                             .columns = texts(tables[i], "columns", path, false),
                             .across = text_or(tables[i], "across", path),
                             .values = texts(tables[i], "values", path, tables[i].contains("across")),
                             .average = texts(tables[i], "average", path, false),
                             .headings = with_common(words(tables[i], "headings", path), common),
                             .where = words(tables[i], "where", path)};
        if (tables[i].contains("digits")) {
            const Key digits{"digits", KeyKind::Whole, 1, 17};
            table.digits = static_cast<int>(std::get<double>(read_value(tables[i]["digits"], digits, in(path, "digits"))));
        }
        if (!table.values.empty() && table.across.empty()) refuse(in(path, "across"), "this key is missing; 'values' needs it");
        study.tables.push_back(std::move(table));
    }
    const Json& plots = optional_list(json, "plots", root);
    for (std::size_t i = 0; i < plots.size(); ++i) {
        const std::string path = at(in(root, "plots"), i);
        const std::vector<std::string> known{"title", "caption", "x",   "y",        "series", "panels",  "average",
                                             "log_x", "log_y",   "fit", "headings", "where",  "together"};
        check_object(plots[i], path, known);
        study.plots.push_back({.title = text_or(plots[i], "title", path, study.title),
                               .caption = text_or(plots[i], "caption", path),
                               .x = texts(plots[i], "x", path, true).front(),
                               .y = texts(plots[i], "y", path, true).front(),
                               .series = texts(plots[i], "series", path, true),
                               .panels = text_or(plots[i], "panels", path),
                               .average = texts(plots[i], "average", path, false),
                               .together = texts(plots[i], "together", path, false),
                               .headings = with_common(words(plots[i], "headings", path), common),
                               .log_x = flag_or(plots[i], "log_x", path, true),
                               .log_y = flag_or(plots[i], "log_y", path, true),
                               .fit = flag_or(plots[i], "fit", path, false),
                               .where = words(plots[i], "where", path)});
    }
    const Json& demands = optional_list(json, "demands", root);
    for (std::size_t i = 0; i < demands.size(); ++i) {
        const std::string path = at(in(root, "demands"), i);
        const std::vector<std::string> known{"metric", "least", "most", "where"};
        check_object(demands[i], path, known);
        StudyDemand demand{.metric = texts(demands[i], "metric", path, true).front(),
                           .where = words(demands[i], "where", path)};
        for (auto [key, value] : {std::pair{"least", &demand.least}, {"most", &demand.most}}) {
            if (!demands[i].contains(key)) continue;
            if (!demands[i][key].is_number()) refuse(in(path, key), must_be("a number", demands[i][key]));
            *value = demands[i][key].get<double>();
        }
        if (!demand.least && !demand.most) refuse(path, "a demand needs 'least' or 'most'");
        study.demands.push_back(std::move(demand));
    }
}

}  // namespace subvol::detail
