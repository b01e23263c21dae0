// SPDX-License-Identifier: Apache-2.0
// The verb `study`: it runs the cases of studies and writes a report.
//
//     names or files ─► studies ─► cases, each in a process of its own ─► results ─► tables, plots, manifest of hashes
//                                                                         │
//     results that earlier runs left in the folder ───────────────────────┴──────► one report of all
//
// Cases that are finished are kept and not run again unless that is asked for. Where costs are measured, cases run one after
// the other with all cores; else several run at the same time and share the cores. A folder is locked while a run writes to
// it. A study that can no longer be read is left out of the report with a warning. The exit code is 1 if a case fails, a
// demand of a study is not met, or a reference did not converge where that is required.
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "child_process.h"
#include "input.h"
#include "options.h"
#include "outputs.h"
#include "quantities.h"
#include "report.h"
#include "study_input.h"
#include "study_runner.h"
#include "study_work.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/text_codes.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/option.h"
#include "subvol/study.h"
#include "subvol/study_measures.h"
#include "subvol/study_report.h"
#include "subvol/study_run.h"
#include "subvol/study_table.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

/// A study as it was read: its JSON, the file that its paths start from, and the command that runs it.
struct StudySource {
    std::string json;
    std::filesystem::path file;
    std::string command;
};

/// A study in a folder, and what has been finished of it.
struct KeptStudy {
    StudyResults results;
    std::string command;
};

namespace fs = std::filesystem;

constexpr const char* kFile = "study.json";

KeptStudy read_kept(const fs::path& folder) {
    const std::string file = (folder / kFile).string();
    const Json json = Json::parse(detail::of_limited_depth(detail::read_regular(file), file));
    const Study study = parse_study(json.at("study").dump(), json.at("file").get<std::string>(), study_picture_methods());
    return {finished_results(study, folder), json.at("command").get<std::string>()};
}

/// Writes FOLDER/study.json, so that reports of later runs in the same folder contain the study, too.
void keep_study(const StudySource& source, const fs::path& folder) {
    const Json json{{"command", source.command}, {"file", source.file.string()}, {"study", Json::parse(source.json)}};
    detail::write_text_file(folder / kFile, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// The studies that earlier runs left in a folder, by name, without those of `but`. One that cannot be read any more, because
/// its meshes are gone, is left out with a warning.
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

namespace fs = std::filesystem;

constexpr int kCaseFailed = 1;  // or a demand is not met
constexpr double kLong_s = 10;
constexpr const char* kPageBytes = "6e6";  // of a page beside the report

/// A number that is not known becomes null.
Json table_json(const StudyTable& table) {
    Json rows = Json::array();
    for (const auto& row : table.rows) {
        Json values = Json::array();
        for (const auto& cell : row) std::visit([&](const auto& value) { values.push_back(value); }, cell);
        rows.push_back(std::move(values));
    }
    Json spreads = Json::array();
    for (const auto& [place, value] : table.spreads)
        spreads.push_back({{"row", place.first}, {"column", place.second}, {"deviation", value}});
    return {{"name", table.name},       {"title", table.title}, {"caption", table.caption},
            {"columns", table.columns}, {"rows", rows},         {"spreads", spreads}};
}

/// As `sha256sum` prints it.
std::string sha256_digits(const std::string& bytes) {
    std::string digits;
    for (const char byte : detail::sha256(bytes)) {
        for (const int shift : {4, 0}) digits += "0123456789abcdef"[static_cast<unsigned char>(byte) >> shift & 15];
    }
    return digits;
}

class StudyVerb : public Verb {
public:
    explicit StudyVerb(CLI::App& program)
        : Verb(program, "study", "Run error studies; write their figures, pictures and a report.",
               "  subvol study --list\n"
               "  subvol study table2 figure7 -o out\n"
               "  subvol study mine.json -o out --jobs 4\n"
               "  subvol study order spacing -o out --mesh part.vtu --field T",
               Reads::NoMesh) {
        add_input(app(), "NAME|FILE", names_, "studies: names from --list, or JSON files (docs/studies.md)")->type_name("");
        add_option(
            app(),
            Option("output", output_)
                .also("o")
                .help("DIR",
                      "the folder: report.html, and for each study a folder with results.csv, costs.csv, cases, pictures"));
        add_option(
            app(),
            Option("mesh", meshes_)
                .help("FILE", "run the study on this mesh with its own field, in place of the study's inputs (repeatable)"));
        add_option(app(), Option("field", field_)
                              .help("EXPR", "the field of the meshes of --mesh, or a quantity (default: the first scalar)")
                              .only_with("mesh"));
        add_option(app(), Option("jobs", jobs_)
                              .between(1, 1024)
                              .help("N", "cases that run at the same time, unless costs are measured (default: one per core)"));
        add_option(app(), Option("resume", resume_)
                              .help("keep the cases that an earlier run of this version finished in the folder (the default)"));
        add_option(app(), Option("fresh", fresh_).help("run all cases again").instead_of({"resume"}));
        add_option(app(),
                   Option("pages", pages_)
                       .help("also a page for each input, on which it can be turned (as `page`); the report links to them"));
        add_option(app(), Option("exr", exr_).help("also keep the pictures of all cases as .exr, with a manifest of hashes"));
        add_option(app(), Option("require-converged", require_converged_).help("exit with 1 if a reference did not converge"));
        add_option(app(), Option("list", list_).help("list the studies"));
        add_option(app(), Option("keys", keys_).help("print all keys, metrics and options of studies as tables (Markdown)"));
        add_option(app(), Option("print", print_).help("NAME", "print a built-in study's file, as a start for your own"));
        add_option(app(), Option("case", case_))->group("");  // how the verb runs its cases, each in a process of its own
        add_option(app(), Option("case-of", case_of_))->group("");
    }

    int run(Report& report) override {
        report.all_said();
        if (list_) return list(report);
        if (keys_) {
            std::cout << study_keys_markdown(study_picture_methods());
            return 0;
        }
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

    /// "about 2 min"; a duration on another machine has one digit.
    static std::string about(double seconds) {
        if (seconds <= 0) return "";
        return seconds < 60 ? text("about ", std::lround(seconds), " s") : text("about ", std::lround(seconds / 60), " min");
    }

    static int list(Report& report) {
        for (const StudyInfo& info : list_studies()) {
            report["studies"].push_back({{"name", info.name}, {"description", info.title}, {"seconds", info.seconds}});
            report.say(
                text(std::left, std::setw(9), info.name, std::right, std::setw(13), about(info.seconds), "  ", info.title));
        }
        return 0;
    }

    [[nodiscard]] StudySource load(const std::string& name) const {
        StudySource source{.json = {}, .file = name, .command = command({name})};
        if (fs::path(name).extension() == ".json") {
            if (!meshes_.empty())
                throw Error(ErrorCode::InvalidInput, "is for studies by name: a file lists its own inputs", "--mesh");
            (void)read_study(name, study_picture_methods());  // says what is wrong with the file
            std::ifstream in(name);
            source.json.assign(std::istreambuf_iterator<char>(in), {});
            source.file = fs::absolute(name);
        } else {
            source.json = with_meshes(name, Json::parse(built_in_study_json(name))).dump();
        }
        if (exr_) {
            Json json = Json::parse(source.json);
            json["exr"] = true;
            source.json = json.dump();
        }
        return source;
    }

    /// A built-in study of the user's meshes alone: with their fields, and refined as the study refines its first input.
    [[nodiscard]] Json with_meshes(const std::string& name, Json json) const {
        if (meshes_.empty()) return json;
        if (!json.contains("inputs")) throw Error(ErrorCode::InvalidInput, "the study '" + name + "' takes no mesh", "--mesh");
        Json inputs = Json::array();
        for (const std::string& mesh : meshes_) {
            Json input = json["inputs"].front();
            for (const char* key : {"model", "resolution", "given", "density"}) input.erase(key);
            input["file"] = fs::absolute(mesh).string();
            input["name"] = plain_name(fs::path(mesh).stem().string());
            if (!field_.empty()) input["field"] = field_;
            inputs.push_back(std::move(input));
        }
        json["inputs"] = std::move(inputs);
        json["about"] = json.value("about", std::string()) +
                        " Here the inputs of the study are replaced by meshes of the user with their own fields.";
        if (json.contains("tables")) leave_out_published(json["tables"]);
        return json;
    }

    /// Leaves out the columns with published numbers about a study's own inputs, and the tables of these alone.
    static void leave_out_published(Json& tables) {
        const auto published = [](const std::string& key) { return key.starts_with("given."); };
        Json own = Json::array();
        for (Json& table : tables) {
            bool about_others = false;
            const Json where = table.value("where", Json::object());
            for (const auto& item : where.items()) about_others = about_others || published(item.key());
            for (const char* list : {"rows", "columns", "average"}) {
                if (!table.contains(list)) continue;
                Json kept = Json::array();
                for (const Json& key : table[list]) {
                    if (!published(key.get<std::string>())) kept.push_back(key);
                }
                table[list] = std::move(kept);
            }
            if (!about_others) own.push_back(std::move(table));
        }
        tables = std::move(own);
    }

    static std::string plain_name(std::string name) {
        for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' ? c : '_';
        return name.substr(0, 64);
    }

    int run_studies(Report& report) {
        if (names_.empty()) throw Error(ErrorCode::InvalidInput, "needs the name of a study", "study", "see --list");
        std::vector<StudySource> sources;
        std::vector<Study> studies;
        for (const std::string& name : names_) {
            sources.push_back(load(name));
            studies.push_back(parse_study(sources.back().json, name, study_picture_methods()));
        }
        check_names(studies);
        make_folder(output_);
        const FolderLock alone(output_);
        for (const Study& study : studies) {
            if (study.seconds > kLong_s) report.note(text(study.name, " takes ", about(study.seconds), " on two cores"));
        }
        std::size_t failed = 0;
        std::vector<StudyResults> all;
        for (std::size_t i = 0; i < studies.size(); ++i) {
            const Study& study = studies[i];
            all.push_back(report.timed(study.name.c_str(), [&] { return run_one(study, report); }));
            keep_study(sources[i], fs::path(output_) / study.name);
            failed += all.back().failed;
            report_results(all.back(), report);
            write_manifest(sources[i], all.back());
        }
        const std::size_t open = report_references(all, report);
        const std::size_t unmet = report_demands(all, report);
        const ReportFacts pages = pages_ ? make_pages(studies, report) : ReportFacts{};
        write_page(std::move(all), pages, report);
        return failed > 0 || unmet > 0 || (require_converged_ && open > 0) ? kCaseFailed : 0;
    }

    /// returns: how many did not converge
    static std::size_t report_references(const std::vector<StudyResults>& all, Report& report) {
        std::size_t open = 0;
        report["not_converged"] = Json::array();
        for (const StudyResults& results : all) {
            for (const ReferenceState& reference : reference_states(results)) {
                if (reference.converged) continue;
                ++open;
                report["not_converged"].push_back({{"study", results.study.name}, {"reference", reference.name}});
                report.warn(text(results.study.name, ": the reference of ", reference.name,
                                 " did not converge: figures of it are bounds (reference: max_levels, tolerance)"));
            }
        }
        return open;
    }

    /// returns: how many are not met
    static std::size_t report_demands(const std::vector<StudyResults>& all, Report& report) {
        std::size_t unmet = 0;
        report["demands"] = Json::array();
        for (const StudyResults& results : all) {
            for (const Judgement& judgement : judge(results)) {
                report["demands"].push_back({{"study", results.study.name},
                                             {"demand", judgement.words},
                                             {"cases", judgement.cases},
                                             {"met", judgement.met}});
                if (judgement.all_met()) continue;
                ++unmet;
                report.warn(text(results.study.name, ": a demand is not met: ", judgement.words));
            }
        }
        return unmet;
    }

    /// A page of each input, made by the verb `page` in a process of its own. returns: names and paths
    [[nodiscard]] ReportFacts make_pages(const std::vector<Study>& studies, Report& report) const {
        ReportFacts pages;
        const fs::path folder = fs::path(output_) / "pages";
        std::set<std::string> known;
        for (const Study& study : studies) {
            for (const StudyCase& item : study.cases) {
                if (!item.has("input") || !(item.has("input.model") || item.has("input.file"))) continue;
                const std::string name = plain_name(item.text("input"));
                if (!known.insert(name).second) continue;
                fs::create_directories(folder);
                const fs::path page = folder / (name + ".html");
                const detail::TemporaryFile mesh(name + ".vtu");
                (void)write_mesh(mesh.path(), study_mesh(item));
                const ChildResult made = report.timed("pages", [&] {
                    return run_self({"page", mesh.path().string(), "-o", page.string(), "--title", name, "--max-bytes",
                                     kPageBytes, "--quiet"});
                });
                if (made.code != 0) {
                    report.warn(text("no page of ", name, ": ", made.err.substr(0, made.err.find('\n'))));
                    continue;
                }
                pages.emplace_back(item.text("input"), "pages/" + name + ".html");
                report["pages"].push_back(page.string());
            }
        }
        return pages;
    }

    /// The page has what earlier runs left in the folder, too.
    void write_page(std::vector<StudyResults> all, const ReportFacts& pages, Report& report) const {
        std::set<std::string> names, commands;
        std::string lines;
        const auto add_command = [&](const std::string& words) {
            if (commands.insert(words).second) lines += (lines.empty() ? "" : "\n") + words;
        };
        for (const StudyResults& results : all) names.insert(results.study.name);
        std::vector<StudyResults> shown;
        for (KeptStudy& kept : kept_studies(output_, names, report)) {
            report["kept"].push_back(kept.results.study.name);
            add_command(kept.command);
            shown.push_back(std::move(kept.results));
        }
        add_command(command(names_));
        std::ranges::move(all, std::back_inserter(shown));
        const fs::path page = fs::path(output_) / "report.html";
        detail::write_text_file(page, report_html(shown, output_, {study_host(), study_versions(), lines, pages}));
        report["output"] = output_;
        report["report"] = page.string();
        report.say("\n" + text("The report is ", page.string()));
    }

    /// A word as a shell reads it.
    static std::string shell_word(const std::string& word) {
        const auto plain = [](unsigned char c) {
            return std::isalnum(c) != 0 || std::string_view("._-/+=:,@%").find(static_cast<char>(c)) != std::string_view::npos;
        };
        if (std::all_of(word.begin(), word.end(), plain)) return word;
        std::string quoted = "'";
        for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
        return quoted + "'";
    }

    /// The command that runs the same studies again.
    [[nodiscard]] std::string command(const std::vector<std::string>& names) const {
        std::string words = "subvol study";
        for (const std::string& name : names) words += " " + name;
        for (const std::string& mesh : meshes_) words += " --mesh " + shell_word(mesh);
        if (!field_.empty()) words += " --field " + shell_word(field_);
        return words + (exr_ ? " --exr -o " : " -o ") + output_;
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
        const auto finished = [&](const StudyCase& item, const CaseResult& result, bool ran) {
            if (!result.failure.empty()) report.warn(text(study.name, ": ", item.name, ": ", result.failure));
            if (ran && result.failure.empty()) report.say(text(study.name, ": ", item.name));
        };
        return run_study(study, [&](const StudyCase& item) { return runner.run(item, study.name); },
                         {.folder = fs::path(output_) / study.name,
                          .jobs = jobs,
                          .fresh = fresh_,
                          .finished = finished,
                          .progress = report.progress()});
    }

    /// Writes which program made which picture: a run of the same command by it gives the same hashes.
    void write_manifest(const StudySource& source, const StudyResults& results) const {
        const fs::path folder = fs::path(output_) / results.study.name, references = fs::path(output_) / "references";
        Json pictures = Json::array();
        std::set<std::string> known;
        const auto add = [&](const fs::path& at, const std::string& name, Json about) {
            std::error_code missing;
            if (!fs::is_regular_file(at / name, missing)) return;
            about["file"] = fs::relative(at / name, output_).string();
            about["sha256"] = sha256_digits(detail::read_regular((at / name).string()));
            pictures.push_back(std::move(about));
        };
        for (std::size_t i = 0; i < results.results.size(); ++i) {
            const CaseResult& result = results.results[i];
            const auto note = [&](const char* key) { return result.notes.contains(key) ? result.notes.at(key) : ""; };
            if (!result.files.contains("exr")) continue;
            add(folder, result.files.at("exr"),
                {{"case", results.study.cases[i].name}, {"id", results.study.cases[i].id}, {"camera", note("camera_used")}});
            if (known.insert(note("reference")).second)
                add(references, note("reference") + ".exr", {{"reference", note("reference")}});
        }
        if (pictures.empty()) return;
        Json manifest{{"command", source.command}, {"study", Json::parse(source.json)}, {"pictures", std::move(pictures)}};
        for (const auto& [name, value] : study_versions()) manifest["versions"][name] = value;
        detail::write_text_file(folder / "manifest.json", manifest.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
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
            detail::write_text_file(folder / (table.name + ".tex"), as_tex(table));
            report["tables"].push_back(table_json(table));
            report.say("\n" + as_text(table));
        }
        if (const auto setup = setup_table(results)) {
            detail::write_text_file(folder / (setup->name + ".csv"), as_csv(*setup));
            detail::write_text_file(folder / (setup->name + ".tex"), as_tex(*setup));
        }
        for (const StudyPlot& plot : make_plots(results)) {
            const auto write = [&](const char* ending, const std::string& content) {
                detail::write_text_file(folder / (plot.name + ending), content);
            };
            write(".svg", plot_svg_file(plot.plot));
            write(".pdf", plot_pdf(plot.plot));
            write("_84mm.pdf", plot_pdf(plot.plot, kColumnPlot));
            write("_84mm.svg", plot_svg_file(plot.plot, kColumnPlot));
            write("_174mm.pdf", plot_pdf(plot.plot, kPagePlot));
            write("_174mm.svg", plot_svg_file(plot.plot, kPagePlot));
            write(".tex", plot_tex(plot.plot));
            write(".csv", plot_csv(plot.plot));
        }
    }

    std::vector<std::string> names_;
    std::string output_;
    std::vector<std::string> meshes_;
    std::string field_;
    std::optional<int> jobs_;
    bool resume_ = true;
    bool fresh_ = false;
    bool list_ = false;
    bool pages_ = false;
    bool exr_ = false;
    bool require_converged_ = false;
    bool keys_ = false;
    std::string print_;
    std::string case_;
    std::string case_of_;
};

}  // namespace

std::unique_ptr<Verb> make_study_verb(CLI::App& program) {
    return std::make_unique<StudyVerb>(program);
}

}  // namespace subvol::cli
