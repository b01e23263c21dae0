// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "study_keys.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/json_depth.h"
#include "subvol/error.h"
#include "subvol/study_run.h"
#include "subvol/version.h"

namespace subvol {

using namespace detail;

namespace fs = std::filesystem;

namespace {

using detail::Json;

constexpr std::uintmax_t kMaxCaseBytes = 1 << 20;

// Another version of the program may compute another result. The id does not contain it: the results of two versions can be
// compared case by case.
constexpr const char* kProgram = "subvol " SUBVOL_VERSION;

/// JSON has no infinite numbers; they are written as strings, as in the table.
Json number_json(double value) {
    return std::isfinite(value) ? Json(value) : Json(as_text(StudyValue(value)));
}

double number_from(const Json& json) {
    if (json.is_number()) return json.get<double>();
    const auto text = json.get<std::string>();
    if (text == "inf") return INFINITY;
    return text == "-inf" ? -INFINITY : NAN;
}

Json result_json(const CaseResult& result) {
    Json metrics = Json::object(), costs = Json::object();
    for (const auto& [key, value] : result.metrics) metrics[key] = number_json(value);
    for (const auto& [key, value] : result.costs) costs[key] = number_json(value);
    Json json{{"metrics", metrics}, {"costs", costs}, {"files", result.files}, {"notes", result.notes}};
    if (!result.failure.empty()) json["failure"] = result.failure;
    return json;
}

CaseResult result_from(const Json& json) {
    CaseResult result;
    for (const auto& [key, value] : json.at("metrics").items()) result.metrics[key] = number_from(value);
    for (const auto& [key, value] : json.at("costs").items()) result.costs[key] = number_from(value);
    for (const auto& [key, value] : json.at("files").items()) result.files[key] = value.get<std::string>();
    for (const auto& [key, value] : json.at("notes").items()) result.notes[key] = value.get<std::string>();
    result.failure = json.value("failure", "");
    return result;
}

std::string quoted(const std::string& field) {
    if (field.find_first_of(",\"\n\r") == std::string::npos) return field;
    std::string text = "\"";
    for (const char c : field) text += c == '"' ? std::string("\"\"") : std::string(1, c);
    return text + '"';
}

class Csv {
public:
    void field(const std::string& text) { line_ += (line_.empty() ? "" : ",") + quoted(text); }
    void empty_field() { line_ += ','; }
    void end() {
        text_ += line_ + '\n';
        line_.clear();
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string line_, text_;
};

template <class Map>
void put(Csv& csv, const Map& values, const std::set<std::string>& keys) {
    for (const std::string& key : keys) {
        const auto found = values.find(key);
        found == values.end() ? csv.empty_field() : csv.field(as_text(StudyValue(found->second)));
    }
}

std::string one_line(std::string text) {
    for (char& c : text) c = c == '\n' || c == '\r' ? ' ' : c;
    return text;
}

}  // namespace

std::string to_json(const CaseResult& result) {
    return result_json(result).dump(-1, ' ', false, Json::error_handler_t::replace);
}

CaseResult case_result_from_json(std::string_view text) {
    try {
        return result_from(Json::parse(of_limited_depth(text, "study")));
    } catch (const nlohmann::json::exception& error) {
        throw Error(ErrorCode::InvalidInput, std::string("is not a result: ") + error.what(), "study");
    }
}

void write_case(const fs::path& file, const StudyCase& study_case, const CaseResult& result) {
    Json json = Json::parse(to_json(study_case));
    json["program"] = kProgram;
    const Json ended = result_json(result);
    for (const auto& [key, value] : ended.items()) json[key] = value;
    write_text_file(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::optional<CaseResult> read_finished_case(const fs::path& file, const StudyCase& study_case, const fs::path& folder) {
    std::error_code error;
    const auto bytes = fs::file_size(file, error);
    if (error || bytes > kMaxCaseBytes) return {};
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    try {
        const Json json = Json::parse(of_limited_depth(text.str(), file.string()));
        if (json.at("id").get<std::string>() != study_case.id || json.at("program").get<std::string>() != kProgram) return {};
        CaseResult result = result_from(json);
        if (!result.failure.empty()) return {};
        for (const auto& [key, name] : result.files) {
            if (!fs::exists(folder / name)) return {};
        }
        return result;
    } catch (const nlohmann::json::exception&) {
        return {};
    } catch (const Error&) {  // nested too deep
        return {};
    }
}

std::string results_csv(const StudyResults& all) {
    std::set<std::string> values, metrics;
    for (const StudyCase& study_case : all.study.cases) {
        for (const auto& [key, value] : study_case.values) values.insert(key);
    }
    for (const CaseResult& result : all.results) {
        for (const auto& [key, value] : result.metrics) metrics.insert(key);
    }
    Csv csv;
    for (const char* key : {"id", "name"}) csv.field(key);
    for (const auto* keys : {&values, &metrics}) {
        for (const std::string& key : *keys) csv.field(key);
    }
    csv.field("failure");
    csv.end();
    for (std::size_t i = 0; i < all.results.size(); ++i) {
        csv.field(all.study.cases[i].id);
        csv.field(all.study.cases[i].name);
        put(csv, all.study.cases[i].values, values);
        put(csv, all.results[i].metrics, metrics);
        csv.field(one_line(all.results[i].failure));
        csv.end();
    }
    return csv.text();
}

std::string costs_csv(const StudyResults& all) {
    std::set<std::string> costs;
    for (const CaseResult& result : all.results) {
        for (const auto& [key, value] : result.costs) costs.insert(key);
    }
    Csv csv;
    for (const char* key : {"id", "name"}) csv.field(key);
    for (const std::string& key : costs) csv.field(key);
    csv.end();
    for (std::size_t i = 0; i < all.results.size(); ++i) {
        csv.field(all.study.cases[i].id);
        csv.field(all.study.cases[i].name);
        put(csv, all.results[i].costs, costs);
        csv.end();
    }
    return csv.text();
}

}  // namespace subvol
