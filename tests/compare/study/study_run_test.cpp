// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "lib/comma_locale.h"
#include "lib/temp_folder.h"
#include "subvol/study_run.h"
#include "subvol/study_table.h"
#include "subvol/version.h"

namespace subvol {
namespace study_run_test {

using test::error_of;
using test::read_bytes;

/// Eight cases, which compute the square root of their seed.
Study seeds() {
    return parse_study(R"({"name": "seeds", "inputs": [{"model": "ball"}], "measured": "root",
        "methods": [{"method": "field", "seed": [0, 1, 2, 3, 4, 5, 6, 7]}],
        "tables": [{"rows": "seed", "columns": ["root", "done"]}]})",
                       "seeds.json", {});
}

CaseResult root_of(const StudyCase& of) {
    static std::atomic<int> calls = 0;
    CaseResult result;
    result.metrics["root"] = std::sqrt(of.number("seed"));
    result.costs["seconds"] = ++calls;  // different in every run
    return result;
}

class StudyRun : public test::TempFolder {
protected:
    /// Runs the study and returns the seeds of the cases that were run.
    std::vector<double> run(const std::string& folder, const CaseWork& work, int jobs = 1, bool fresh = false) {
        std::vector<double> ran;
        std::mutex mutex;
        const CaseWork noted = [&](const StudyCase& of) {
            {
                const std::lock_guard lock(mutex);
                ran.push_back(of.number("seed"));
            }
            return work(of);
        };
        last_ = run_study(seeds(), noted, {.folder = path(folder), .jobs = jobs, .fresh = fresh});
        std::ranges::sort(ran);
        return ran;
    }

    [[nodiscard]] std::string results(const std::string& folder) const { return read_bytes(path(folder) / "results.csv"); }

    StudyResults last_;
};

/// Ends the run like a signal, not as a failure of the case.
CaseResult cancelled_at_five(const StudyCase& of) {
    if (of.number("seed") == 5) throw Error(ErrorCode::Cancelled, "interrupted");
    return root_of(of);
}

TEST_F(StudyRun, AFinishedCaseIsNotRunAgain) {
    EXPECT_EQ(run("a", root_of), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(last_.ran, 8U);
    const std::string costs = read_bytes(path("a") / "costs.csv");
    EXPECT_TRUE(run("a", root_of).empty());
    EXPECT_EQ(last_.ran, 0U);
    EXPECT_EQ(last_.results[4].metrics.at("root"), 2);
    EXPECT_EQ(read_bytes(path("a") / "costs.csv"), costs);  // costs are kept too
    EXPECT_EQ(run("a", root_of, 1, true).size(), 8U);
}

TEST_F(StudyRun, AnInterruptedOneGoesOnAndEndsTheSame) {
    (void)run("whole", root_of);
    EXPECT_NE(error_of([&] { (void)run("a", cancelled_at_five); }, ErrorCode::Cancelled), "no error");
    EXPECT_FALSE(std::filesystem::exists(path("a") / "results.csv"));
    EXPECT_EQ(run("a", root_of), (std::vector<double>{5, 6, 7}));
    EXPECT_EQ(results("a"), results("whole"));
}

TEST_F(StudyRun, ResultsAreTheSameForAnyNumberOfJobs) {
    (void)run("one", root_of, 1);
    EXPECT_EQ(run("four", root_of, 4).size(), 8U);
    EXPECT_EQ(results("four"), results("one"));
}

TEST_F(StudyRun, AFailureIsKeptAndLosesNoOther) {
    const auto fails = [](const StudyCase& of) {
        if (of.number("seed") == 3) throw Error(ErrorCode::InvalidInput, "three, \"is\"\nodd");
        return root_of(of);
    };
    EXPECT_EQ(run("a", fails).size(), 8U);
    EXPECT_EQ(last_.failed, 1U);
    EXPECT_EQ(last_.results[3].failure, "three, \"is\"\nodd");
    EXPECT_NE(results("a").find("\"three, \"\"is\"\" odd\""), std::string::npos) << results("a");
    EXPECT_EQ(run("a", root_of), std::vector<double>{3});  // tried again, and no other case
    EXPECT_EQ(last_.failed, 0U);
    (void)run("whole", root_of);
    EXPECT_EQ(results("a"), results("whole"));
}

TEST_F(StudyRun, DamagedFilesAndOthersCasesAreRunAgain) {
    (void)run("a", root_of);
    const auto file = [&](std::size_t i) { return path("a") / "cases" / (seeds().cases[i].id + ".json"); };
    std::ofstream(file(1)) << "{\"id\": \"";
    std::filesystem::copy_file(file(3), file(2), std::filesystem::copy_options::overwrite_existing);
    std::filesystem::remove(file(6));
    EXPECT_EQ(run("a", root_of), (std::vector<double>{1, 2, 6}));
}

TEST_F(StudyRun, CasesOfAnotherVersionAreRunAgain) {
    (void)run("a", root_of);
    const auto file = [&](std::size_t i) { return path("a") / "cases" / (seeds().cases[i].id + ".json"); };
    const std::string ours = "\"program\": \"subvol " SUBVOL_VERSION "\"";
    std::string other = read_bytes(file(2)), none = read_bytes(file(5));
    ASSERT_NE(other.find(ours), std::string::npos) << other;
    std::ofstream(file(2)) << other.replace(other.find(ours), ours.size(), "\"program\": \"subvol 0.0.9\"");
    std::ofstream(file(5)) << none.replace(none.find(ours), ours.size(), "\"unknown\": 1");  // as versions before 0.1 wrote it
    EXPECT_EQ(run("a", root_of), (std::vector<double>{2, 5}));
    EXPECT_EQ(seeds().cases[2].id.size(), 16U);
    EXPECT_TRUE(run("a", root_of).empty());
}

TEST_F(StudyRun, ACaseWhoseFilesAreGoneIsRunAgain) {
    const auto writes = [&](const StudyCase& of) {
        CaseResult result = root_of(of);
        result.files["picture"] = of.id + ".png";
        std::ofstream(path("a") / result.files["picture"]) << "picture";
        return result;
    };
    (void)run("a", writes);
    std::filesystem::remove(path("a") / (seeds().cases[2].id + ".png"));
    EXPECT_EQ(run("a", writes), std::vector<double>{2});
}

TEST_F(StudyRun, NumbersThatAreNoneReadBack) {
    const StudyCase of = seeds().cases.front();
    const CaseResult result{.metrics = {{"infinite", INFINITY}, {"none", NAN}, {"third", 1. / 3}}, .notes = {{"n", "a\"b"}}};
    write_case(path("case.json"), of, result);
    const auto back = read_finished_case(path("case.json"), of, path("."));
    ASSERT_TRUE(back);
    EXPECT_TRUE(std::isinf(back->metrics.at("infinite")));
    EXPECT_TRUE(std::isnan(back->metrics.at("none")));
    EXPECT_EQ(back->metrics.at("third"), 1. / 3);
    EXPECT_EQ(back->notes, result.notes);
}

TEST_F(StudyRun, AFolderThatCannotBeIsToldOf) {
    write("file", "");
    EXPECT_NE(error_of([&] { (void)run("file/a", root_of); }, ErrorCode::Io).find("file"), std::string::npos);
}

TEST_F(StudyRun, TablesGroupCases) {
    (void)run("a", root_of);
    const auto tables = make_tables(last_);
    ASSERT_EQ(tables.size(), 1U);
    EXPECT_EQ(tables[0].columns, (std::vector<std::string>{"seed", "root", "done"}));
    ASSERT_EQ(tables[0].rows.size(), 8U);
    EXPECT_EQ(std::get<double>(tables[0].rows[4][1]), 2);
    EXPECT_EQ(std::get<std::string>(tables[0].rows[4][2]), "yes");
}

TEST(StudyTable, GoesAcross) {
    const Study study = parse_study(R"({"name": "s", "inputs": [{"model": "ball"}, {"model": "pawn", "given": {"known": 7}}],
        "methods": [{"method": "field", "seed": [0, 1]}],
        "tables": [{"rows": "input", "columns": "given.known", "across": "seed", "values": "rmse", "headings": {"1": "one"}},
                   {"rows": "seed", "where": {"input": "pawn"}}]})",
                                    "s.json", {});
    StudyResults results{.study = study, .results = {}};
    for (int i = 0; i < 4; ++i) results.results.push_back({.metrics = {{"rmse", i}}});
    const auto tables = make_tables(results);
    EXPECT_EQ(as_text(tables[0]), "\ninput  known  0  one\nball       –  0    1\npawn       7  2    3\n");
    EXPECT_EQ(tables[1].rows.size(), 2U);
    EXPECT_EQ(tables[1].name, "s_2");
}

TEST(StudyTable, CellsOfSeveralCasesAreMeansWithTheirSpread) {
    StudyResults results{.study = parse_study(R"({"name": "s", "inputs": [{"model": "ball"}],
        "methods": [{"method": "field", "per_edge": [1, 2], "seed": [0, 1, 2]}],
        "tables": [{"rows": "per_edge", "columns": ["rmse", "kernels"], "average": "seed"}]})",
                                              "s.json", {}),
                         .results = {}};
    for (int i = 0; i < 6; ++i) results.results.push_back({.metrics = {{"rmse", i < 3 ? 1 + i : 7}, {"kernels", 27}}});
    const StudyTable table = make_tables(results).at(0);
    EXPECT_EQ(std::get<double>(table.rows[0][1]), 2);
    EXPECT_EQ(table.spreads.at({0, 1}), 1);  // of 1, 2 and 3
    EXPECT_EQ(shown(table, 0, 1), "2 ± 1");
    EXPECT_EQ(shown(table, 1, 1), "7");  // all are the same
    EXPECT_EQ(shown(table, 0, 2), "27");
    EXPECT_NE(table.caption.find("over the values of seed"), std::string::npos);
    EXPECT_EQ(as_csv(table),
              "\"per edge\",\"rmse\",\"rmse ±\",\"kernels\"\n\"1\",\"2\",\"1\",\"27\"\n\"2\",\"7\",\"–\",\"27\"\n");
}

TEST(StudyTable, HasPointsInEveryLocale) {
    const StudyTable table{"t", "T", "Caption", {"name", "half"}, {{"a", .5}, {"b", 12345.678}, {"c", 1234567.0}}};
    const test::CommaLocale comma;
    EXPECT_EQ(as_text(table), "Caption\nname       half\na           0.5\nb     1.235e+04\nc       1234567\n");
    EXPECT_EQ(as_text(StudyValue(.25)), "0.25");
    EXPECT_EQ(as_text(StudyValue(1234567.0)), "1234567");
}

TEST(StudyTable, IsAlignedAndQuoted) {
    const StudyTable table{"t", "T", "Caption", {"name", "½"}, {{"a \"b\"", .5}, {"c", 12.0}, {"d", std::nan("")}}};
    EXPECT_EQ(as_text(table), "Caption\nname     ½\na \"b\"  0.5\nc       12\nd        –\n");
    EXPECT_EQ(as_csv(table), "\"name\",\"½\"\n\"a \"\"b\"\"\",\"0.5\"\n\"c\",\"12\"\n\"d\",\"–\"\n");
}

}  // namespace study_run_test
}  // namespace subvol
