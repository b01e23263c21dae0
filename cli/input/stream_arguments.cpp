// SPDX-License-Identifier: Apache-2.0
#include "stream_arguments.h"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "input.h"
#include "options.h"
#include "places_input.h"
#include "subvol/option.h"

namespace subvol::cli {

void StreamArguments::add_to(CLI::App& app) {
    for (const Option& option : options_of(chosen)) {
        add_option(app, option);
        if (option.name == "streamlines") add_seeds_to(app);
    }
}

void StreamArguments::add_lines_to(CLI::App& app) {
    add_option(app, Option("streamlines", chosen.streamlines)
                        .help("EXPR", "write streamlines of this vector instead of a surface (.vtp, .csv)"));
    add_seeds_to(app);
    for (const Option& option : options_of(chosen)) {
        if (option.name == "seed-count" || option.name.starts_with("stream-")) add_option(app, option);
    }
}

void StreamArguments::add_seeds_to(CLI::App& app) {
    add_option(app,
               Option("seeds", seeds)
                   .help("PLACES",
                         "where streamlines start: at:x,y,z, line:x0,y0,z0,x1,y1,z1, disk:x,y,z,nx,ny,nz,r, sphere:x,y,z,r, "
                         "box:x0,y0,z0,x1,y1,z1, or a table of places (repeatable; default: the middles of cells)")
                   .only_with("streamlines"));
}

std::vector<Vec3> StreamArguments::places(const HexMesh& mesh, const LimitOptions& limit) const {
    if (seeds.empty()) return middles_of_cells(mesh, chosen.seed_count, limit);
    std::vector<Vec3> places;
    for (const std::string& text : seeds) {
        std::error_code ignored;
        const bool is_file = std::filesystem::is_regular_file(text, ignored);
        const std::vector<Vec3> more =
            is_file ? read_places(text) : of_option("--seeds", [&] { return parse_seeds(text, chosen.seed_count); });
        places.insert(places.end(), more.begin(), more.end());
    }
    return places;
}

}  // namespace subvol::cli
