// SPDX-License-Identifier: Apache-2.0
#include "built_in_studies.h"
#include "study_keys.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol {

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

Study built_in_study(const std::string& name) {
    return parse_study(built_in_study_json(name), name);
}

}  // namespace subvol
