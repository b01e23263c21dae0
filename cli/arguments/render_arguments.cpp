// SPDX-License-Identifier: Apache-2.0
#include "render_arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>

#include "choices.h"
#include "options.h"
#include "subvol/option.h"
#include "text.h"

namespace subvol::cli {

void RenderArguments::add_to(CLI::App& app) {
    add_option(app,
               Option("method", method_name_)
                   .offer(names_of<Method>())
                   .help("NAME",
                         "splat (kernels), sheets (the same by OpenGL buffers), footprints (kernels coloured first), "
                         "tets (rays through tetrahedra), pt (the same tetrahedra projected by OpenGL), dense (rays through "
                         "the limit's cells) or grid (rays through a .vdb file's voxels)"));
    picture.add_to(app);
    add_options(app, options_of(clip));
    sample.add_to(app);
    PictureSettings any;
    const std::vector<Option> all = options_of(any);
    refine.add_to(app, std::ranges::find(all, "levels", &Option::name)->sentence);
    splat.add_to(app);
    add_options(app, options_of(chosen));
}

std::vector<Option> RenderArguments::described() {
    std::vector<Option> all = sample.described();
    for (auto more : {refine.described(), splat.described(), options_of(clip), options_of(chosen)})
        std::ranges::move(more, std::back_inserter(all));
    return all;
}

void RenderArguments::settle(BodyKind input, bool level_set, const CLI::App& app) {
    method = named<Method>(method_name_, "--method");
    body = input;
    const bool is_mesh = body == BodyKind::Mesh;
    if (is_mesh) tets = TetRefinement(refine);
    if (tets.asked()) body = BodyKind::Tets;
    picture.settle_look((is_mesh || body == BodyKind::Bricks || level_set) && !splat.shade);
    if (level_set && draws_kernels(method)) picture.refuse_isosurfaces_of_level_set();
    check_method(method, body);
    check_options(bit(method), body, given_options(app));
    validate(method_options({{0, 0, 0}, {1, 1, 1}}, {0, 1}, nullptr));
    picture.check();
}

MethodOptions RenderArguments::method_options(const Box& box, const Range& field, Progress* progress) const {
    MethodOptions options = chosen;
    options.style.method = method;
    options.style.look = picture.look_options(field);
    options.style.clip = clip;
    options.kernels = sample.kernel_options(box, refine.options(0, progress), refine.levels);
    options.drop_invisible = sample.drops_invisible();
    options.splat = splat.options();
    return options;
}

}  // namespace subvol::cli
