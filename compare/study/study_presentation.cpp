// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "study_keys.h"
#include "subvol/detail/several_errors.h"

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

namespace {

using Known = std::vector<std::string>;

/// A part of the report, read key by key, so that all of its mistakes are found.
class PartReader {
public:
    /// known: all keys that it may have
    PartReader(const Json& json, std::string path, const Known& known) : json_(json), path_(std::move(path)) {
        is_object_ = mistakes_.none_in([&] {
            if (!json.is_object()) refuse(path_, must_be("an object", json));
        });
        if (is_object_) mistakes_.none_in([&] { check_object(json, path_, known); });
    }

    /// Gives a member what `read` makes of the part.
    template <class Value, class Read>
    void take(Value& value, const Read& read) {
        if (is_object_) mistakes_.none_in([&] { value = read(json_, path_); });
    }
    void text(std::string& value, const char* key, const std::string& otherwise = {}) {
        take(value, [&](const Json& json, const std::string& path) { return text_or(json, key, path, otherwise); });
    }
    void list(Known& value, const char* key, bool needed = false) {
        take(value, [&](const Json& json, const std::string& path) { return texts(json, key, path, needed); });
    }
    void first(std::string& value, const char* key) {
        take(value, [&](const Json& json, const std::string& path) { return texts(json, key, path, true).front(); });
    }
    void flag(bool& value, const char* key) {
        take(value, [&](const Json& json, const std::string& path) { return flag_or(json, key, path, value); });
    }
    void headings(std::map<std::string, std::string>& value, const std::map<std::string, std::string>& common) {
        take(value,
             [&](const Json& json, const std::string& path) { return with_common(words(json, "headings", path), common); });
    }
    void where(StudyFilter& value) {
        take(value, [&](const Json& json, const std::string& path) { return words(json, "where", path); });
    }

    void check() const { mistakes_.check(); }

private:
    const Json& json_;
    std::string path_;
    bool is_object_ = false;
    Mistakes mistakes_;
};

using Headings = std::map<std::string, std::string>;

void read_table(const Json& json, const std::string& path, const std::string& title, const Headings& common,
                StudyTableSpec& table) {
    static const Known kKnown{"title",  "caption", "rows",     "columns", "across",
                              "values", "average", "headings", "where",   "digits"};
    PartReader part(json, path, kKnown);
    part.text(table.title, "title", title);
    part.text(table.caption, "caption");
    part.list(table.rows, "rows", true);
    part.list(table.columns, "columns");
    part.text(table.across, "across");
    part.list(table.values, "values", json.contains("across"));
    part.list(table.average, "average");
    part.headings(table.headings, common);
    part.where(table.where);
    part.take(table.digits, [&](const Json& own, const std::string& place) {
        const Key digits{"digits", KeyKind::Whole, 1, 17};
        if (!own.contains("digits")) return table.digits;
        return static_cast<int>(std::get<double>(read_value(own["digits"], digits, in(place, "digits"))));
    });
    part.take(table.across, [&](const Json& own, const std::string& place) {
        if (own.contains("values") && !own.contains("across"))
            refuse(in(place, "across"), "this key is missing; 'values' needs it");
        return table.across;
    });
    part.check();
}

void read_plot(const Json& json, const std::string& path, const std::string& title, const Headings& common,
               StudyPlotSpec& plot) {
    static const Known kKnown{"title", "caption", "x",   "y",        "series", "panels",  "average",
                              "log_x", "log_y",   "fit", "headings", "where",  "together"};
    PartReader part(json, path, kKnown);
    part.text(plot.title, "title", title);
    part.text(plot.caption, "caption");
    part.first(plot.x, "x");
    part.first(plot.y, "y");
    part.list(plot.series, "series", true);
    part.text(plot.panels, "panels");
    part.list(plot.average, "average");
    part.list(plot.together, "together");
    part.headings(plot.headings, common);
    part.flag(plot.log_x, "log_x");
    part.flag(plot.log_y, "log_y");
    part.flag(plot.fit, "fit");
    part.where(plot.where);
    part.check();
}

void read_demand(const Json& json, const std::string& path, StudyDemand& demand) {
    static const Known kKnown{"metric", "least", "most", "where"};
    PartReader part(json, path, kKnown);
    part.first(demand.metric, "metric");
    part.where(demand.where);
    for (auto [key, value] : {std::pair{"least", &demand.least}, {"most", &demand.most}}) {
        const char* const name = key;
        part.take(*value, [&](const Json& own, const std::string& place) -> std::optional<double> {
            if (!own.contains(name)) return std::nullopt;
            if (!own[name].is_number()) refuse(in(place, name), must_be("a number", own[name]));
            return own[name].get<double>();
        });
    }
    part.take(demand.least, [&](const Json& own, const std::string& place) {
        if (!own.contains("least") && !own.contains("most")) refuse(place, "a demand needs 'least' or 'most'");
        return demand.least;
    });
    part.check();
}

}  // namespace

void read_presentation(const Json& json, const std::string& root, Study& study) {
    Mistakes mistakes;
    Headings common;
    mistakes.none_in([&] { common = words(json, "headings", root); });
    if (json.contains("pictures") && json["pictures"].is_object()) {
        study.pictures = true;
        mistakes.none_in([&] { study.pictures_where = words(json, "pictures", root); });
    }
    mistakes.none_in([&] { study.measured = texts(json, "measured", root, false); });
    const auto each = [&](const char* key, const auto& read) {
        mistakes.none_in([&] {
            const Json& parts = optional_list(json, key, root);
            for (std::size_t i = 0; i < parts.size(); ++i) mistakes.none_in([&] { read(parts[i], at(in(root, key), i)); });
        });
    };
    // A part with a mistake stays as far as it could be read: its keys are checked, too.
    each("tables", [&](const Json& part, const std::string& path) {
        read_table(part, path, study.title, common, study.tables.emplace_back());
    });
    each("plots", [&](const Json& part, const std::string& path) {
        read_plot(part, path, study.title, common, study.plots.emplace_back());
    });
    each("demands", [&](const Json& part, const std::string& path) { read_demand(part, path, study.demands.emplace_back()); });
    mistakes.check();
}

}  // namespace subvol::detail
