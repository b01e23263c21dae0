// SPDX-License-Identifier: Apache-2.0
#include "vdb_arguments.h"

#include <CLI/CLI.hpp>

#include "numbers.h"
#include "options.h"
#include "subvol/option.h"

namespace subvol::cli {

namespace {

constexpr const char* kDefaultLevelSet = "sdf";

}  // namespace

void VdbArguments::add_sizes_to(CLI::App& app) {
    for (const Option& option : options_of(grids)) {
        if (option.name == "voxel-size" || option.name == "resolution") add_option(app, option);
    }
    add_option(app, Option("like", like)
                        .help("FILE", "use the transform of the first grid in this .vdb file")
                        .instead_of({"voxel-size", "resolution"}));
    add_option(app, Option("budget", budget_bytes)
                        .bytes()
                        .help("BYTES", "choose voxels so that the grids take about this much memory, e.g. 500M")
                        .instead_of({"voxel-size", "resolution", "like"}));
}

void VdbArguments::add_grids_to(CLI::App& app) {
    add_option(
        app, Option("fields", fields)
                 .help("A,B=C",
                       "fields to write, the first as fog volume; a field with three components becomes a grid of vectors, "
                       "NAME.k is its component k. GRID=FIELD names the grid; GRID=EXPRESSION computes it from x, y, z and the "
                       "fields, e.g. \"heat=(Temp-293)/620,speed=length(V)\""));
    add_option(app, Option("remap", remaps)
                        .help("[GRID=]LO,HI[:A,B]",
                              "values from LO to HI become 0 to 1, or A to B, what is beyond becomes the nearer of these; of "
                              "the first field or of GRID (repeatable)"));
    add_option(app, Option("clamp", clamp)
                        .help("keep values within the range of the field at the mesh's points: interpolating schemes overshoot "
                              "between them"));
    add_option(app, Option("prune", prune)
                        .between(0, 1e30)
                        .help("T",
                              "leave out voxels whose value is at most this far from the background, 0; of vectors their "
                              "length counts"));
    add_option(app, Option("up", up).help("AXIS", "the axis that is up: z, or y as in most programs for pictures (default z)"));
    add_option(app, Option("scale", scale).positive().help("S", "multiply all coordinates by this"));
    for (const Option& option : options_of(grids)) {
        if (option.name != "voxel-size" && option.name != "resolution") add_option(app, option);
    }
    add_option(app, Option("error", error)
                        .help("also write for each field a grid NAME_error: an upper bound of |value - limit| at each voxel"));
    const std::vector<Option> level_set = options_of(level_set_asked);
    level_set_option = app.add_option("--sdf", level_set_asked.name, level_set.front().sentence);
    level_set_option->type_name(level_set.front().about)->expected(0, 1);
    add_option(app, level_set.back());
    add_option(app, Option("from", from)
                        .offer({"mesh", "points"})
                        .help("WHAT",
                              "what is rasterized: mesh, or points: kernels sampled from it, summed at the voxels of the mesh; "
                              "not needed for a FILE of points (.ply, .vtp, .svk, .vdb)"));
    add_option(
        app, Option("per-edge", per_edge).between(1, 64).help("N", "sample intervals per edge").only_with("from", {"points"}));
}

void VdbArguments::add_files_to(CLI::App& app) {
    add_option(app, Option("compression", compression).help("NAME", "blosc, zip, none"));
    add_option(app,
               Option("memory", memory_bytes)
                   .bytes()
                   .help("BYTES",
                         "make the grids in parts that take no more than this, e.g. 2G. If all together take no more, "
                         "NAME.vdb has them, else NAME_0000.vdb and so on; NAME.json lists the file or the files, and join "
                         "makes one of them. Of bricks also what the cells about a part take (default 1G)"));
    add_option(app, Option("nano", nano).help("also write a NanoVDB file, NAME.nvdb; needs a build with NanoVDB"));
}

void VdbArguments::add_frames_to(CLI::App& app) {
    add_option(app, Option("frames", frames)
                        .help("A-B",
                              "a sequence: A-B, or N for 1-N. In FILE and --output a row of # is replaced by the number of the "
                              "frame, padded with zeros to that many digits"))
        ->transform(frame_range());
    add_option(app,
               Option("to", to).help(
                   "FILE", "a sequence from FILE to this mesh of the same cells: points and values are interpolated linearly"));
    add_option(
        app,
        Option("velocity", velocity)
            .help("also write a grid of vectors, named vel: the velocity of the volume, in world units per frame; of steps per "
                  "unit of their time; of a mesh that stands still that of the flow in it (U, V, velocity)"));
    add_option(app, Option("fps", frames_per_second)
                        .positive()
                        .help("F", "with --velocity: in world units per second, at this many frames per second")
                        .only_with("velocity"));
}

std::optional<LevelSetOptions> VdbArguments::level_set() const {
    if (level_set_option->count() == 0) return std::nullopt;
    LevelSetOptions options = level_set_asked;
    if (options.name.empty()) options.name = kDefaultLevelSet;
    return options;
}

}  // namespace subvol::cli
