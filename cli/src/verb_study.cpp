#include <filesystem>
#include <fstream>

#include "input.h"
#include "subvol/atomic_file.h"
#include "subvol/error.h"
#include "subvol/study.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

void write_text(const std::filesystem::path& path, const std::string& content) {
    AtomicFile file(path);
    std::ofstream out(file.path(), std::ios::binary);
    out << content;
    out.close();
    if (!out) throw Error(ErrorCode::Io, "could not be written", path.string());
    file.commit();
}

/// A row as an object by the columns' names; a number that does not exist is null.
Json to_json(const StudyTable& table) {
    Json rows = Json::array();
    for (const auto& row : table.rows) {
        Json values = Json::array();
        for (const auto& cell : row) std::visit([&](const auto& value) { values.push_back(value); }, cell);
        rows.push_back(std::move(values));
    }
    return {{"name", table.name}, {"caption", table.caption}, {"columns", table.columns}, {"rows", std::move(rows)}};
}

class StudyVerb : public Verb {
public:
    explicit StudyVerb(CLI::App& program)
        : Verb(program, "study", "Run error studies and write their tables.",
               "  subvol study --list\n"
               "  subvol study table2 -o out\n"
               "  subvol study order spacing -o out --mesh part.vtu") {
        app().add_option("NAME", names_, "the studies to run")->type_name("NAME");
        app().add_option("-o,--output", output_, "the folder for the tables (NAME.txt, NAME.csv, NAME.json)")->type_name("DIR");
        app()
            .add_option("--mesh", meshes_, "order, spacing: a mesh that takes part besides the models (repeatable)")
            ->type_name("FILE");
        app().add_flag("--list", list_, "list the studies");
    }

    int run(Report& report) override {
        list_ ? list(report) : study(report);
        report.all_said();
        return 0;
    }

private:
    static void list(Report& report) {
        for (const StudyInfo& info : list_studies()) {
            report["studies"].push_back({{"name", info.name}, {"description", info.description}});
            report.say(text(info.name, ": ", info.description));
        }
    }

    void study(Report& report) {
        if (names_.empty()) throw Error(ErrorCode::InvalidInput, "needs the name of a study", "study", "see --list");
        if (output_.empty()) throw Error(ErrorCode::InvalidInput, "needs a folder to write to", "study", "-o DIR");
        std::vector<std::string> known;
        for (const StudyInfo& info : list_studies()) known.push_back(info.name);
        for (const std::string& name : names_) check_choice("study", name, known);
        StudyOptions options{.meshes = {}, .seed = common().seed, .progress = report.progress()};
        for (const std::string& mesh : meshes_) options.meshes.emplace_back(mesh);
        make_folder();
        for (const std::string& name : names_) {
            const auto tables = report.timed(name.c_str(), [&] { return run_study(name, options); });
            for (const StudyTable& table : tables) write(table, report);
        }
        report["output"] = output_;
    }

    void make_folder() const {
        std::error_code error;
        std::filesystem::create_directories(output_, error);
        if (error || !std::filesystem::is_directory(output_)) throw Error(ErrorCode::Io, "the folder cannot be made", output_);
    }

    void write(const StudyTable& table, Report& report) const {
        const std::filesystem::path stem = std::filesystem::path(output_) / table.name;
        write_text(stem.string() + ".txt", as_text(table));
        write_text(stem.string() + ".csv", as_csv(table));
        write_text(stem.string() + ".json", to_json(table).dump(2) + "\n");
        report["tables"].push_back(to_json(table));
        report.say(as_text(table));
    }

    std::vector<std::string> names_;
    std::string output_;
    std::vector<std::string> meshes_;
    bool list_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_study_verb(CLI::App& program) {
    return std::make_unique<StudyVerb>(program);
}

}  // namespace subvol::cli
