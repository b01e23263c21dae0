// SPDX-License-Identifier: Apache-2.0
#include "kept_studies.h"

#include <algorithm>
#include <fstream>

#include "subvol/detail/atomic_file.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "study.json";

KeptStudy read_kept(const fs::path& folder) {
    const std::string file = (folder / kFile).string();
    const Json json = Json::parse(detail::of_limited_depth(detail::read_regular(file), file));
    const Study study = parse_study(json.at("study").dump(), json.at("file").get<std::string>());
    return {finished_results(study, folder), json.at("command").get<std::string>()};
}

}  // namespace

void keep_study(const StudySource& source, const fs::path& folder) {
    const Json json{{"command", source.command}, {"file", source.file.string()}, {"study", Json::parse(source.json)}};
    detail::write_text_file(folder / kFile, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::vector<KeptStudy> kept_studies(const fs::path& folder, const std::set<std::string>& but, Report& report) {
    std::vector<fs::path> folders;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        if (but.contains(entry.path().filename().string())) continue;
        std::error_code ignored;
        if (fs::is_regular_file(entry.path() / kFile, ignored)) folders.push_back(entry.path());
    }
    std::ranges::sort(folders);
    std::vector<KeptStudy> all;
    for (const fs::path& one : folders) {
        std::string why;
        try {
            KeptStudy kept = read_kept(one);
            if (!kept.results.results.empty()) all.push_back(std::move(kept));
        } catch (const Error& error) {
            why = error.what();
        } catch (const nlohmann::json::exception& error) {
            why = error.what();
        }
        if (!why.empty()) report.warn(text("the report leaves out the study in ", one.string(), ": ", why));
    }
    return all;
}

}  // namespace subvol::cli
