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

namespace subvol::cli {

namespace {

void add_mesh_options(CLI::App& app, CommonOptions& options) {
    const std::string group = "Reading meshes";
    const std::vector<Option> described = options_of(options.read);
    const auto add = [&](const char* name) {
        CLI::Option* const added = add_option(app, *std::ranges::find(described, name, &Option::name));
        return added->group(group);
    };
    add("other-cells");
    app.add_flag("--weld", options.weld, "join points of a file that are at the same place")->group(group);
    add("weld-distance");
    add("curved");
    add("cell-values");
    add("patch-values");
    Option step = *std::ranges::find(described, "step", &Option::name);
    step.value = &options.step;
    step.help("N|last|all|A-B", step.sentence + ", or last; of verbs that write a file a step also all or A-B");
    add_option(app, step)->group(group);
    add("time");
    app.add_flag("--interpolate-time", options.interpolate_time, "points and values between the two steps around --time")
        ->group(group)
        ->needs("--time");
    add("blocks")->delimiter(',');
    add("sharp")->allow_extra_args(false);
    add("mesh");
}

}  // namespace

void add_common_options(CLI::App& app, CommonOptions& options, Reads reads) {
    const std::string group = "Common options";
    if (reads == Reads::Meshes) {
        const std::string of_meshes = "Reading meshes";
        auto* field = app.add_option(
            "--field", options.field,
            "the field to use, or a quantity such as U.x, mises(S) or grad(T) (default: a physical scalar, else the first "
            "scalar, stress or vector, else density 1)");
        field->group(of_meshes)->type_name("EXPR");
        app.add_option("--density", options.density, "an expression in x, y, z to use as the field, e.g. \"sin(3*x)+z\"")
            ->group(of_meshes)
            ->type_name("EXPR")
            ->excludes(field);
        app.add_option(
               "--warp", options.warp,
               "move the points by this vector field, times a factor; auto: the longest becomes a tenth of the box's diagonal")
            ->group(of_meshes)
            ->type_name("FIELD[*S|*auto]");
        app.add_option("--only", options.only,
                       "only the cells in a region: block:A,B, box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r, half:px,py,pz,nx,ny,nz, "
                       "set:NAME, fold:VERDICT or where:EXPR (repeatable: in all of them)")
            ->group(of_meshes)
            ->type_name("REGION")
            ->allow_extra_args(false);
        app.add_flag("--clamp-file", options.clamp_file,
                     "keep the fields between the points within the range that they have in the file, of cells in that of the "
                     "cells; --clamp file is the same")
            ->group(of_meshes);
        add_mesh_options(app, options);
    }
    options.app = &app;
    add_option(app, Option("threads", options.threads)
                        .between(0, detail::kMostThreads)
                        .help("N", "number of threads (0: all); results do not depend on it"))
        ->group(group);
    app.add_flag("--json", options.json, "print one JSON object on standard output, also if there is an error")->group(group);
    app.add_flag("--quiet", options.quiet, "print nothing but errors (and the JSON object)")->group(group);
    app.add_option("--progress", options.progress, "show a progress bar on standard error: auto (on a terminal), on, off")
        ->group(group)
        ->type_name("WHEN")
        ->check(one_of({"auto", "on", "off"}));
    add_option(app, Option("seed", options.seed).help("N", "seed of the random numbers that place samples"))->group(group);
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
