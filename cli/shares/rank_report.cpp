// SPDX-License-Identifier: Apache-2.0
#include "rank_report.h"

namespace subvol::cli {

void gather_list(Ranks& ranks, Report& report, const char* key) {
    const Json mine = report.json().value(key, Json::array());
    Json all = Json::array();
    for (const std::string& bytes : ranks.gather(mine.dump())) {
        for (const Json& item : Json::parse(bytes)) all.push_back(item);
    }
    if (ranks.first()) report[key] = std::move(all);
}

void report_ranks(Ranks& ranks, Report& report) {
    const std::int64_t sent = ranks.bytes_sent();  // without what this function sends
    const std::vector<std::string> figures = ranks.gather(Json{{"sent", sent}, {"peak", peak_memory_bytes()}}.dump());
    if (!ranks.first()) return;
    std::int64_t all = 0;
    Json peaks = Json::array();
    for (const std::string& bytes : figures) {
        const Json one = Json::parse(bytes);
        all += one["sent"].get<std::int64_t>();
        peaks.push_back(one["peak"]);
    }
    report["ranks"] = ranks.size();
    report["bytes_sent"] = all;
    report["peak_bytes_of_ranks"] = std::move(peaks);
}

}  // namespace subvol::cli
