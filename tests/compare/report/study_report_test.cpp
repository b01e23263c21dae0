// SPDX-License-Identifier: Apache-2.0
#include "subvol/study_report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/temp_folder.h"

namespace subvol {
namespace {

Study demanding() {
    return parse_study(R"({"name": "s", "title": "<b>Title</b> & more", "about": "About 'it'", "pictures": true,
        "inputs": [{"model": "ball"}, {"model": "pawn"}], "methods": [{"method": "splat", "label": "<i>"}],
        "tables": [{"rows": "input", "columns": "psnr", "headings": {"psnr": "PSNR <dB>"}}],
        "plots": [{"x": "kernels", "y": "psnr", "series": "input", "title": "P", "log_y": false}],
        "demands": [{"metric": "psnr", "least": 40}]})",
                       "s.json");
}

StudyResults results() {
    StudyResults all{.study = demanding(), .results = {}};
    all.results.push_back({.metrics = {{"psnr", 44.5}, {"kernels", 10}}});
    all.results.push_back({.metrics = {{"psnr", 31}, {"kernels", 20}}});
    return all;
}

TEST(Report, JudgesDemands) {
    auto judged = judge(results());
    ASSERT_EQ(judged.size(), 1U);
    EXPECT_EQ(judged[0].words, "PSNR <dB> at least 40: 1 of 2; the worst is pawn with 31");
    EXPECT_FALSE(judged[0].all_met());
    StudyResults failed = results();
    failed.results[1] = {.failure = "broke down"};
    EXPECT_EQ(judge(failed)[0].met, 1U);  // a failed case meets no demand
    EXPECT_EQ(judge(failed)[0].cases, 2U);
    StudyResults equal = results();
    equal.results[1].metrics["psnr"] = INFINITY;
    EXPECT_TRUE(judge(equal)[0].all_met());
}

TEST(Report, IsOnePageWithAllWordsEscaped) {
    const std::vector<StudyResults> all{results()};
    const std::string html = report_html(all, "nowhere", {{{"cpu", "<x>"}}, {{"v", "1"}}, "subvol study \"a\" <b>"});
    EXPECT_TRUE(html.starts_with("<!DOCTYPE html>"));
    for (const char* raw : {"<b>Title", "<i>", "<x>", "<dB>", "http:", "https:"})
        EXPECT_EQ(html.find(raw), std::string::npos) << raw;
    for (const char* said : {"&lt;b&gt;Title&lt;/b&gt; &amp; more", "0 of 1 demand met", "viewport", "44.5", "31", "<svg",
                             "subvol study &quot;a&quot; &lt;b&gt;", "@media print", "&lt;x&gt;"}) {
        EXPECT_NE(html.find(said), std::string::npos) << said;
    }
}

class ReportFolder : public test::TempFolder {};

TEST_F(ReportFolder, PicturesAreInIt) {
    std::vector<StudyResults> all{results()};
    std::filesystem::create_directories(path("s"));
    write("s/a.png", "\x89PNG");
    all[0].results[0].files = {{"picture", "a.png"}, {"difference", "gone.png"}, {"reference", "a.png"}};
    const std::string html = report_html(all, path(""), {});
    EXPECT_NE(html.find("data:image/png;base64,iVBORw=="), std::string::npos);  // RFC 4648 of the four bytes
    EXPECT_NE(html.find("missing: gone.png"), std::string::npos);
    EXPECT_NE(html.find("type=\"range\""), std::string::npos);
}

}  // namespace
}  // namespace subvol
