// SPDX-License-Identifier: Apache-2.0
#include "vdb_arguments.h"

#include <CLI/CLI.hpp>

#include "choices.h"
#include "numbers.h"

namespace subvol::cli {

namespace {

constexpr const char* kDefaultLevelSet = "sdf";

}  // namespace

void VdbArguments::add_sizes_to(CLI::App& app) {
    auto* by_size = app.add_option("--voxel-size", voxel_size, "edge of a voxel in world units");
    by_size->type_name("H")->transform(positive_number());
    auto* by_resolution =
        app.add_option("--resolution", resolution, "voxels along the longest side of the bounding box (default 200)");
    by_resolution->type_name("N")->transform(whole_number(1, 1 << 20))->excludes(by_size);
    auto* by_grid = app.add_option("--like", like, "use the transform of the first grid in this .vdb file");
    by_grid->type_name("FILE")->excludes(by_size)->excludes(by_resolution);
    app.add_option("--budget", budget_bytes, "choose voxels so that the grids take about this much memory, e.g. 500M")
        ->type_name("BYTES")
        ->transform(byte_count())
        ->excludes(by_size)
        ->excludes(by_resolution)
        ->excludes(by_grid);
}

void VdbArguments::add_grids_to(CLI::App& app) {
    app.add_option("--fields", fields,
                   "fields to write, the first as fog volume; a field with three components becomes a grid of vectors, "
                   "NAME.k is its component k. GRID=FIELD names the grid; GRID=EXPRESSION computes it from x, y, z and the "
                   "fields, e.g. \"heat=(Temp-293)/620,speed=length(V)\"")
        ->type_name("A,B=C");
    app.add_option("--remap", remaps,
                   "values from LO to HI become 0 to 1, or A to B, what is beyond becomes the nearer of these; of the first "
                   "field or of GRID (repeatable)")
        ->type_name("[GRID=]LO,HI[:A,B]")
        ->allow_extra_args(false);
    app.add_flag("--clamp", clamp, "keep values within the range of the field: interpolating schemes overshoot");
    app.add_option("--up", up, "the axis that is up: z, or y as in most programs for pictures (default z)")->type_name("AXIS");
    app.add_option("--scale", scale, "multiply all coordinates by this")->type_name("S")->transform(positive_number());
    app.add_flag("--cell-ids", cell_numbers, "also write a grid: the number of the control cell");
    app.add_flag("--mask", mask, "also write a grid: a mask of the volume");
    app.add_flag("--error", error,
                 "also write for each field a grid NAME_error: an upper bound of |value - limit| at each voxel");
    app.add_flag("--coverage", coverage, "also write a grid: the part of each voxel that the volume fills");
    level_set_option = app.add_option("--sdf", level_set_asked.name,
                                      "also write a level set, named NAME or sdf: the distance to the boundary, negative "
                                      "inside, in a narrow band");
    level_set_option->type_name("[NAME]")->expected(0, 1);
    app.add_option("--half-width", level_set_asked.half_width_voxels, "the band's reach to either side, in voxels (default 3)")
        ->type_name("N")
        ->transform(number_in(1.0, 1000.0))
        ->needs(level_set_option);
    app.add_flag("--half", half, "store floats in 16 bits");
    app.add_option("--from", from,
                   "what is rasterized: mesh, or points: kernels sampled from it, summed at the voxels of the mesh; not needed "
                   "for a FILE of points (.ply, .vtp, .svk, .vdb)")
        ->type_name("WHAT")
        ->check(offered({"mesh", "points"}));
    app.add_option("--per-edge", per_edge, "with --from points: sample intervals per edge")
        ->type_name("N")
        ->transform(whole_number(1, 64));
}

void VdbArguments::add_files_to(CLI::App& app) {
    app.add_option("--compression", compression, "blosc (the default), zip, none")
        ->type_name("NAME")
        ->check(one_of(names_of<VdbCompression>()));
    app.add_option("--memory", memory_bytes,
                   "make the grids in parts that take no more than this, e.g. 2G. If all together take no more, NAME.vdb has "
                   "them, else NAME_0000.vdb and so on; NAME.json lists the file or the files, and join makes one of them. Of "
                   "bricks also what the cells about a part take (default 1G)")
        ->type_name("BYTES")
        ->transform(byte_count());
    app.add_flag("--nano", nano, "also write a NanoVDB file, NAME.nvdb; needs a build with NanoVDB");
}

void VdbArguments::add_frames_to(CLI::App& app) {
    app.add_option("--frames", frames,
                   "a sequence: A-B, or N for 1-N. In FILE and --output a row of # is replaced by the number of the frame, "
                   "padded with zeros to that many digits")
        ->type_name("A-B")
        ->transform(frame_range());
    app.add_option("--to", to,
                   "a sequence from FILE to this mesh of the same cells: points and values are interpolated linearly")
        ->type_name("FILE");
    auto* asks_velocity =
        app.add_flag("--velocity", velocity,
                     "also write a grid of vectors, named vel: the velocity of the volume, in world units per frame; of "
                     "steps per unit of their time");
    app.add_option("--fps", frames_per_second, "with --velocity: in world units per second, at this many frames per second")
        ->type_name("F")
        ->transform(positive_number())
        ->needs(asks_velocity);
}

std::optional<LevelSetOptions> VdbArguments::level_set() const {
    if (level_set_option->count() == 0) return std::nullopt;
    LevelSetOptions options = level_set_asked;
    if (options.name.empty()) options.name = kDefaultLevelSet;
    return options;
}

}  // namespace subvol::cli
