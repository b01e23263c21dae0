// SPDX-License-Identifier: Apache-2.0
#include "subvol/study_report.h"
#include "subvol/study_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "compare/study/picture_methods.h"
#include "lib/temp_folder.h"

namespace subvol {
namespace study_report_test {

Study demanding() {
    return parse_study(R"({"name": "s", "title": "<b>Title</b> & more", "about": "About 'it'", "pictures": true,
        "inputs": [{"model": "ball"}, {"model": "pawn"}], "methods": [{"method": "splat", "label": "<i>"}],
        "tables": [{"rows": "input", "columns": "psnr", "headings": {"psnr": "PSNR <dB>"}}],
        "plots": [{"x": "kernels", "y": "psnr", "series": "input", "title": "P", "log_y": false}],
        "demands": [{"metric": "psnr", "least": 40}]})",
                       "s.json", picture_methods());
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

/// A picture study with a reference that last changed by 1e-3.
StudyResults known_to_a_thousandth() {
    StudyResults all{.study = parse_study(R"({"name": "s", "inputs": [{"model": "ball"}], "cameras": ["iso"], "size": [64, 48],
        "methods": [{"method": "splat", "per_edge": [1, 2]}], "metrics": ["rmse", "psnr"],
        "tables": [{"rows": "per_edge", "columns": ["rmse", "psnr", "seconds"], "headings": {"rmse": "RMSE & more"}}],
        "plots": [{"x": "kernels", "y": "rmse", "series": "label"}]})",
                                          "s.json", picture_methods()),
                     .results = {}};
    for (const double rmse : {1e-2, 1e-4}) {
        all.results.push_back({.metrics = {{"rmse", rmse},
                                           {"psnr", -20 * std::log10(rmse)},
                                           {"reference_change", 1e-3},
                                           {"reference_level", 4},
                                           {"cells", 512},
                                           {"points", 729},
                                           {"kernels", rmse < 1e-3 ? 10. : 100.}},
                               .costs = {{"seconds", .5}},
                               .notes = {{"reference", "abc"}}});
    }
    return all;
}

TEST(Report, MarksWhatTheReferenceCannotTell) {
    const StudyTable table = make_tables(known_to_a_thousandth()).at(0);
    EXPECT_EQ(shown(table, 0, 1), "0.01");
    EXPECT_EQ(shown(table, 1, 1), "≤ 0.001");
    EXPECT_EQ(shown(table, 0, 2), "40");
    EXPECT_EQ(shown(table, 1, 2), "≥ 60");
    EXPECT_EQ(shown(table, 1, 3), "0.5");                 // a time has no such bound
    EXPECT_EQ(std::get<double>(table.rows[1][1]), 1e-4);  // programs get the number
    EXPECT_NE(as_csv(table).find("\"0.0001\",\"80\""), std::string::npos) << as_csv(table);
    EXPECT_NE(as_text(table).find("≤ 0.001"), std::string::npos);
    EXPECT_FALSE(accuracy({.metrics = {{"rmse", 1}}}, "rmse"));  // a reference of a fixed level
}

TEST(Report, EveryMetricHasItsFloor) {
    CaseResult result{.metrics = {{"flip", .01},
                                  {"floor_flip", .02},
                                  {"ssim", .9999},
                                  {"floor_ssim", .9995},
                                  {"max", .5},
                                  {"floor_max", .1},
                                  {"psnr_edge", 50},
                                  {"floor_psnr_edge", 49},
                                  {"rmse", 0},
                                  {"floor_rmse", 0}}};
    EXPECT_EQ(mark_of(result, "flip"), "≤ 0.02");
    EXPECT_EQ(mark_of(result, "ssim"), "≥ 0.9995");
    EXPECT_EQ(mark_of(result, "psnr_edge"), "≥ 49");
    EXPECT_FALSE(mark_of(result, "max"));
    EXPECT_FALSE(mark_of(result, "rmse"));  // an exact reference
    result.metrics.erase("flip");
    EXPECT_FALSE(mark_of(result, "flip"));
    result.notes["own_reference"] = "drawn by the same method";
    EXPECT_EQ(mark_of(result, "flip"), "= reference");
    EXPECT_FALSE(mark_of(result, "seconds"));
}

TEST(Report, SaysWhichReferencesDidNotConverge) {
    StudyResults all = known_to_a_thousandth();
    EXPECT_TRUE(reference_states(all).at(0).converged);
    for (CaseResult& result : all.results) result.metrics["reference_converged"] = 0;
    ASSERT_EQ(reference_states(all).size(), 1U);
    EXPECT_FALSE(reference_states(all)[0].converged);
    const std::vector<StudyResults> studies{all};
    const std::string page = report_html(studies, "nowhere", {});
    EXPECT_NE(page.find("The reference of ball, iso, viridis did not converge"), std::string::npos);
    EXPECT_NE(page.find("1 of 1 references did not converge"), std::string::npos);
    EXPECT_NE(page.find("-10 log10(mse), linear RGB, peak 1"), std::string::npos);  // what PSNR is
}

TEST(Report, SaysThatAClosedFormIsTheReference) {
    StudyResults all = known_to_a_thousandth();
    for (CaseResult& result : all.results) result.metrics.erase("reference_level");
    const std::vector<StudyResults> studies{all};
    const std::string page = report_html(studies, "nowhere", {});
    EXPECT_NE(page.find("rays through the closed form of the field, with steps that were halved"), std::string::npos);
    EXPECT_EQ(page.find("dense grid"), std::string::npos);
}

TEST(Report, SaysHowThePicturesWereMade) {
    const auto setup = setup_table(known_to_a_thousandth());
    ASSERT_TRUE(setup);
    ASSERT_EQ(setup->rows.size(), 1U);  // one reference for both cases
    const std::string row = as_csv(*setup);
    for (const char* part :
         {"\"ball\"", "\"512\"", "\"729\"", "\"iso\"", "\"viridis\"", "\"64 × 48\"", "\"4\"", "\"0.001\"", "\"60\""})
        EXPECT_NE(row.find(part), std::string::npos) << part << row;
    EXPECT_FALSE(setup_table(results()));
    const std::vector<StudyResults> all{known_to_a_thousandth()};
    const std::string page = report_html(
        all, "nowhere", {{{"processor", "a CPU"}}, {{"subvol", "1.2.3"}, {"commit", "abcdef"}, {"date", "2026-01-02"}}, "c"});
    for (const char* said : {"Methods, for a paper", "512 hexahedra", "64 × 48 pixels", "OpenSubVol 1.2.3, commit abcdef",
                             "@software{", "{2026}", "last changes 0.001", "s_plot.svg</code>", "s.csv</code>", "≤ 0.001"}) {
        EXPECT_NE(page.find(said), std::string::npos) << said;
    }
}

TEST(Report, TablesOfLatexHaveItsSignsEscaped) {
    const std::string tex = as_tex(make_tables(known_to_a_thousandth()).at(0));
    for (const char* part :
         {"\\begin{tabular}{rrrr}", "RMSE \\& more", "2 & $\\leq$ 0.001 & $\\geq$ 60 & 0.5 \\\\", "\\bottomrule"})
        EXPECT_NE(tex.find(part), std::string::npos) << part << tex;
    StudyTable words;
    words.columns = {"a_b", "50 %"};
    words.rows = {{std::string("x{y}\\z"), 1e300}};
    const std::string escaped = as_tex(words);
    for (const char* part : {"a\\_b", "50 \\%", "x\\{y\\}\\textbackslash{}z", "{lr}"})
        EXPECT_NE(escaped.find(part), std::string::npos) << part << escaped;
}

TEST(Report, LinesJoinWhatIsSwept) {
    // Finer kernels in half the time: in the order of the sweep the line goes back; it does not join other meshes.
    StudyResults all{.study = parse_study(R"({"name": "s", "inputs": [{"model": "ball"}, {"model": "pawn"}],
        "methods": [{"method": "field", "per_edge": [1, 2, 4], "label": "l"}],
        "plots": [{"x": "seconds", "y": "rmse", "series": "label", "together": "input"}]})",
                                          "s.json", picture_methods()),
                     .results = {}};
    for (const StudyCase& of : all.study.cases) {
        all.results.push_back(
            {.metrics = {{"rmse", 1 / of.number("per_edge")}}, .costs = {{"seconds", 8 / of.number("per_edge")}}});
    }
    const auto plots = make_plots(all);
    ASSERT_EQ(plots.size(), 1U);
    EXPECT_EQ(plots[0].name, "s_plot");
    const PlotLine& line = plots[0].plot.lines.at(0);
    EXPECT_EQ(line.x, (std::vector<double>{8, 4, 2, 8, 4, 2}));
    EXPECT_EQ(line.breaks, (std::vector<std::size_t>{3}));
}

}  // namespace study_report_test
}  // namespace subvol
