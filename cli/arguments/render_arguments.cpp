// SPDX-License-Identifier: Apache-2.0
#include "render_arguments.h"

#include <CLI/CLI.hpp>

#include "choices.h"
#include "numbers.h"
#include "render_method.h"
#include "text.h"

namespace subvol::cli {
namespace {

const std::vector<std::string> kMethods{"splat", "sheets", "footprints", "tets", "pt", "dense", "grid"};

}  // namespace

void RenderArguments::add_to(CLI::App& app) {
    app.add_option("--method", method,
                   "splat (kernels, the default), sheets (the same by OpenGL sheet buffers), "
                   "footprints (kernels coloured first), tets (rays through tetrahedra), "
                   "pt (the same tetrahedra projected by OpenGL), dense (rays through the limit's cells) or "
                   "grid (rays through a .vdb file's voxels)")
        ->type_name("NAME")
        ->check(offered(kMethods));
    picture.add_to(app);
    clip.add_to(app);
    reference.add_to(app);
    sample.add_to(app);
    refine.add_to(app, "draw the refined mesh of this level (default for tets and pt: 1; for the others: the limit)");
    splat.add_to(app);
    app.add_option("--memory", memory_bytes,
                   "of bricks: what kernels or cells take while a part of the picture is drawn; of .svk files with --lod: "
                   "what is kept for the next frame (default 1G)")
        ->type_name("BYTES")
        ->transform(byte_count());
}

void RenderArguments::settle(bool has_cells, bool in_bricks) {
    check_choice("--method", method, kMethods);
    options = splat.options(method);
    picture.settle_look(has_cells && !splat.shade);
    if (reference.samples == 0) reference.samples = picture.look == Look::Solid ? 2 : 1;
    options.samples = reference.samples;
    options.clip = reference.clip = clip.clip();
    if (picture.lit()) options.shading = Shading{};
    if (!in_bricks) tets = TetRefinement(refine);
    check_method(method, picture, splat, reference);
    picture.check();
}

}  // namespace subvol::cli
