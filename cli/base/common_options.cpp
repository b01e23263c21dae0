// SPDX-License-Identifier: Apache-2.0
#include "common_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "choices.h"
#include "numbers.h"
#include "options.h"
#include "subvol/detail/most_threads.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "text.h"

namespace subvol::cli {

namespace {

/// What is made of a mesh that was read.
std::vector<Option> options_of_cells(CommonOptions& options, bool several) {
    Option field = several ? Option("field", options.fields) : Option("field", options.field);
    field.help("EXPR", text("the field to use, or a quantity such as U.x, mises(S), grad(T) or quality ",
                            several ? "(repeatable: a column and a curve each) " : "",
                            "(default: a physical scalar, else the first scalar, stress or vector, else density 1)"));
    return {std::move(field),
            Option("density", options.density)
                .help("EXPR", "an expression in x, y, z to use as the field, e.g. \"sin(3*x)+z\"")
                .instead_of({"field"}),
            Option("warp", options.warp)
                .help("FIELD[*S|*auto]",
                      "move the points by this vector field, times a factor; auto: the longest becomes a tenth of the box's "
                      "diagonal"),
            Option("only", options.only)
                .help("REGION",
                      "only the cells in a region: block:A,B, box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r, half:px,py,pz,nx,ny,nz, "
                      "set:NAME, nodes:NAME, fold:VERDICT or where:EXPR (repeatable: in all of them)"),
            Option("clamp-file", options.clamp_file)
                .help("keep the fields between the points within the range that they have in the file, of cells in that of the "
                      "cells; --clamp file is the same")};
}

/// Several --field: the first is the one that is used alone, the others are computed beside it.
void take_fields(CommonOptions& options) {
    std::vector<std::string> once;
    for (const std::string& field : options.fields) {
        if (std::ranges::find(once, field) == once.end()) once.push_back(field);
    }
    options.fields = std::move(once);
    if (options.fields.empty()) return;
    options.field = options.fields.front();
    options.at_rest.insert(options.at_rest.end(), options.fields.begin() + 1, options.fields.end());
}

/// Whatever a verb reads.
std::vector<Option> options_of_calls(CommonOptions& options) {
    return {Option("threads", options.threads)
                .between(0, detail::kMostThreads)
                .help("N", "number of threads (0: all); results do not depend on it"),
            Option("json", options.json).help("print one JSON object on standard output, also if there is an error"),
            Option("quiet", options.quiet).help("print nothing but errors (and the JSON object)"),
            Option("progress", options.progress)
                .help("WHEN", "show a progress bar on standard error: auto (on a terminal), on, off"),
            Option("seed", options.seed).help("N", "seed of the random numbers that place samples")};
}

void add_mesh_options(CLI::App& app, CommonOptions& options) {
    const std::string group = "Reading meshes";
    const std::vector<Option> described = options_of(options.read);
    const auto add = [&](const char* name) {
        CLI::Option* const added = add_option(app, *std::ranges::find(described, name, &Option::name));
        return added->group(group);
    };
    add("other-cells");
    add_option(app, Option("weld", options.weld).help("join points of a file that are at the same place"))->group(group);
    add("weld-distance");
    add("curved");
    add("cell-values");
    add("patch-values");
    Option step = *std::ranges::find(described, "step", &Option::name);
    step.value = &options.step;
    step.help("N|last|all|A-B", step.sentence + ", or last; of verbs that write a file a step also all or A-B");
    add_option(app, step)->group(group);
    add("time");
    add_option(app, Option("interpolate-time", options.interpolate_time)
                        .help("points and values between the two steps around --time")
                        .only_with("time"))
        ->group(group);
    add("blocks");
    add("sharp");
    add("mesh");
}

}  // namespace

void add_common_options(CLI::App& app, CommonOptions& options, Reads reads) {
    if (reads != Reads::NoMesh) {
        const bool several = reads == Reads::SeveralFields;
        if (several) app.parse_complete_callback([&options] { take_fields(options); });
        for (const Option& option : options_of_cells(options, several)) add_option(app, option)->group("Reading meshes");
        add_mesh_options(app, options);
    }
    options.app = &app;
    for (const Option& option : options_of_calls(options)) add_option(app, option)->group("Common options");
    app.get_option("--progress")->check(one_of({"auto", "on", "off"}));
}

void add_crease_angle(CLI::App& app, CommonOptions& options) {
    const std::vector<Option> described = options_of(options.read);
    add_option(app, *std::ranges::find(described, "crease-angle", &Option::name));
}

void refuse_options(const CLI::App& app, std::initializer_list<const char*> names, const std::string& reason) {
    for (const char* name : names) {
        const CLI::Option* option = app.get_option_no_throw(name);
        if (option != nullptr && option->count() > 0) throw Error(ErrorCode::InvalidInput, reason, name);
    }
}

void refuse_mesh_options(const CLI::App& app, const std::string& reason) {
    refuse_options(app, {"--density", "--warp", "--only", "--clamp-file"}, reason);
    refuse_file_options(&app, reason);
}

void refuse_file_options(const CLI::App* app, const std::string& reason) {
    if (app == nullptr) return;
    refuse_options(*app,
                   {"--other-cells", "--curved", "--cell-values", "--patch-values", "--step", "--time", "--interpolate-time",
                    "--blocks", "--weld", "--weld-distance", "--sharp", "--mesh"},
                   reason);
}

}  // namespace subvol::cli
