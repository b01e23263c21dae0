// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iomanip>

#include "input.h"
#include "mesh_output.h"
#include "options.h"
#include "outputs.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/option.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

class ModelVerb : public Verb {
public:
    explicit ModelVerb(CLI::App& program)
        : Verb(program, "model", "Generate a model.",
               "  subvol model --list\n"
               "  subvol model twist --resolution 40 -o twist.vtu",
               Reads::NoMesh) {
        add_input(app(), "NAME", name_, "the model's name");
        add_option(
            app(),
            Option("output", output_)
                .also("o")
                .help("FILE", "the mesh to write (.vtu, .vtkhdf, .msh, .e or .foam with its field, .inp or .mesh without)"));
        add_option(app(), Option("resolution", resolution_).between(2, 512).help("N", "cells along the main direction"));
        add_option(app(), Option("list", list_).help("list the models"));
    }

    int run(Report& report) override {
        list_ ? list(report) : generate(report);
        return 0;
    }

private:
    static void list(Report& report) {
        for (const ModelInfo& model : list_models()) {
            report["models"].push_back(
                {{"name", model.name}, {"resolution", model.default_resolution}, {"description", model.description}});
            report.say(text(std::left, std::setw(8), model.name, model.description, "; N = ", model.default_resolution));
        }
        report.all_said();
    }

    void generate(Report& report) {
        if (name_.empty()) throw Error(ErrorCode::InvalidInput, "needs the name of a model", "model", "see --list");
        if (output_.empty()) throw Error(ErrorCode::InvalidInput, "needs a file to write", "model", "-o FILE");
        check_output(output_, writable_mesh_extensions());
        const HexMesh mesh = report.timed("generate", [&] { return make_model(name_, resolution_); });
        report.merge(write_reported(output_, mesh, report.progress()));
        report["output"] = output_;
        report["points"] = mesh.points.size();
        report["cells"] = mesh.cells.size();
    }

    std::string name_;
    std::string output_;
    int resolution_ = 0;
    bool list_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_model_verb(CLI::App& program) {
    return std::make_unique<ModelVerb>(program);
}

}  // namespace subvol::cli
