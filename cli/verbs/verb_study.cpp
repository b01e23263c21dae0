// SPDX-License-Identifier: Apache-2.0
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "input.h"
#include "outputs.h"
#include "study_host.h"
#include "study_runner.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/error.h"
#include "subvol/study.h"
#include "subvol/study_report.h"
#include "subvol/study_run.h"
#include "subvol/study_table.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kCaseFailed = 1;

/// A number that is not known becomes null.
Json to_json(const StudyTable& table) {
    Json rows = Json::array();
    for (const auto& row : table.rows) {
        Json values = Json::array();
        for (const auto& cell : row) std::visit([&](const auto& value) { values.push_back(value); }, cell);
        rows.push_back(std::move(values));
    }
    return {
        {"name", table.name}, {"title", table.title}, {"caption", table.caption}, {"columns", table.columns}, {"rows", rows}};
}

class StudyVerb : public Verb {
public:
    explicit StudyVerb(CLI::App& program)
        : Verb(program, "study", "Run error studies; write their figures, pictures and a report.",
               "  subvol study --list\n"
               "  subvol study table2 figure7 -o out\n"
               "  subvol study mine.json -o out --jobs 4\n"
               "  subvol study order spacing -o out --mesh part.vtu") {
        app().add_option("NAME|FILE", names_, "studies: names from --list, or JSON files (docs/studies.md)")->type_name("");
        app()
            .add_option("-o,--output", output_,
                        "the folder: report.html, and for each study a folder with results.csv, costs.csv, cases, pictures")
            ->type_name("DIR");
        app()
            .add_option("--mesh", meshes_, "another mesh for the study, with the options of its first input (repeatable)")
            ->type_name("FILE");
        app()
            .add_option("--jobs", jobs_, "cases that run at the same time, unless costs are measured (default: one per core)")
            ->type_name("N")
            ->check(CLI::Range(1, 1024));
        auto* resume = app().add_flag(
            "--resume", resume_, "keep the cases that an earlier run of this version finished in the folder (the default)");
        app().add_flag("--fresh", fresh_, "run all cases again")->excludes(resume);
        app().add_flag("--list", list_, "list the studies");
        app().add_option("--print", print_, "print a built-in study's file, as a start for your own")->type_name("NAME");
        app().add_option("--case", case_)->group("");  // how the verb runs its cases, each in a process of its own
        app().add_option("--case-of", case_of_)->group("");
    }

    int run(Report& report) override {
        report.all_said();
        if (list_) return list(report);
        if (!print_.empty()) {
            std::cout << built_in_study_json(print_);
            return 0;
        }
        if (output_.empty()) throw Error(ErrorCode::InvalidInput, "needs a folder to write to", "study", "-o DIR");
        if (!case_.empty()) {
            report.take(Json::parse(to_json_text(run_given_case(case_, output_, case_of_))));
            return 0;
        }
        return run_studies(report);
    }

private:
    static std::string to_json_text(const CaseResult& result) { return subvol::to_json(result); }

    static int list(Report& report) {
        for (const StudyInfo& info : list_studies()) {
            report["studies"].push_back({{"name", info.name}, {"description", info.title}});
            report.say(text(info.name, ": ", info.title));
        }
        return 0;
    }

    [[nodiscard]] Study load(const std::string& name) const {
        const bool file = fs::path(name).extension() == ".json";
        if (file && meshes_.empty()) return read_study(name);
        if (file) throw Error(ErrorCode::InvalidInput, "is for studies by name: a file lists its own inputs", "--mesh");
        Json json = Json::parse(built_in_study_json(name));
        for (const std::string& mesh : meshes_) {
            if (!json.contains("inputs"))
                throw Error(ErrorCode::InvalidInput, "the study '" + name + "' takes no mesh", "--mesh");
            Json input = json["inputs"].front();
            for (const char* key : {"model", "resolution", "given"}) input.erase(key);
            input["file"] = fs::absolute(mesh).string();
            input["name"] = plain_name(fs::path(mesh).stem().string());
            json["inputs"].push_back(std::move(input));
        }
        return parse_study(json.dump(), name);
    }

    static std::string plain_name(std::string name) {
        for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' ? c : '_';
        return name.substr(0, 64);
    }

    int run_studies(Report& report) {
        if (names_.empty()) throw Error(ErrorCode::InvalidInput, "needs the name of a study", "study", "see --list");
        std::vector<Study> studies;
        for (const std::string& name : names_) studies.push_back(load(name));
        check_names(studies);
        make_folder(output_);
        const FolderLock alone(output_);
        std::size_t failed = 0;
        std::vector<StudyResults> all;
        for (const Study& study : studies) {
            all.push_back(report.timed(study.name.c_str(), [&] { return run_one(study, report); }));
            failed += all.back().failed;
            report_results(all.back(), report);
        }
        const fs::path page = fs::path(output_) / "report.html";
        detail::write_text_file(page, report_html(all, output_, {study_host(), study_versions(), command()}));
        report["output"] = output_;
        report["report"] = page.string();
        report.say("\n" + text("The report is ", page.string()));
        return failed > 0 ? kCaseFailed : 0;
    }

    /// The command that runs the same studies again.
    [[nodiscard]] std::string command() const {
        std::string words = "subvol study";
        for (const std::string& name : names_) words += " " + name;
        for (const std::string& mesh : meshes_) words += " --mesh " + mesh;
        return words + " -o " + output_;
    }

    static void check_names(const std::vector<Study>& studies) {
        for (std::size_t i = 0; i < studies.size(); ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                if (studies[i].name != studies[k].name) continue;
                throw Error(ErrorCode::InvalidInput, "two studies have the name '" + studies[i].name + "'", "study");
            }
        }
    }

    [[nodiscard]] StudyResults run_one(const Study& study, Report& report) const {
        const auto cores = static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
        const int jobs = study.timed ? 1 : jobs_.value_or(cores);
        StudyRunner runner(output_, std::max(cores / jobs, 1), cores);
        const auto finished = [&](const StudyCase& of, const CaseResult& result, bool ran) {
            if (!result.failure.empty()) report.warn(text(study.name, ": ", of.name, ": ", result.failure));
            if (ran && result.failure.empty()) report.say(text(study.name, ": ", of.name));
        };
        return run_study(study, [&](const StudyCase& of) { return runner.run(of, study.name); },
                         {.folder = fs::path(output_) / study.name,
                          .jobs = jobs,
                          .fresh = fresh_,
                          .finished = finished,
                          .progress = report.progress()});
    }

    void report_results(const StudyResults& results, Report& report) const {
        const Study& study = results.study;
        const fs::path folder = fs::path(output_) / study.name;
        report["studies"].push_back({{"name", study.name},
                                     {"folder", folder.string()},
                                     {"cases", study.cases.size()},
                                     {"ran", results.ran},
                                     {"failed", results.failed}});
        for (const StudyTable& table : make_tables(results)) {
            detail::write_text_file(folder / (table.name + ".txt"), as_text(table));
            detail::write_text_file(folder / (table.name + ".csv"), as_csv(table));
            report["tables"].push_back(to_json(table));
            report.say("\n" + as_text(table));
        }
    }

    std::vector<std::string> names_;
    std::string output_;
    std::vector<std::string> meshes_;
    std::optional<int> jobs_;
    bool resume_ = true;
    bool fresh_ = false;
    bool list_ = false;
    std::string print_;
    std::string case_;
    std::string case_of_;
};

}  // namespace

std::unique_ptr<Verb> make_study_verb(CLI::App& program) {
    return std::make_unique<StudyVerb>(program);
}

}  // namespace subvol::cli
