// SPDX-License-Identifier: Apache-2.0
#include "built_in_studies.h"
#include "study_keys.h"
#include "subvol/error.h"

namespace subvol {

std::vector<StudyInfo> list_studies() {
    std::vector<StudyInfo> all;
    for (const EmbeddedText& file : kTexts) {
        all.push_back({std::string(file.name), detail::Json::parse(file.text).at("title").get<std::string>()});
    }
    return all;
}

std::string_view built_in_study_json(const std::string& name) {
    std::string known;
    for (const EmbeddedText& file : kTexts) {
        if (file.name == name) return file.text;
        known += (known.empty() ? "" : ", ") + std::string(file.name);
    }
    throw Error(ErrorCode::InvalidInput, "there is no study '" + name + "'", {}, known);
}

Study built_in_study(const std::string& name) {
    return parse_study(built_in_study_json(name), name);
}

}  // namespace subvol
