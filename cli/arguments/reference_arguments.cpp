// SPDX-License-Identifier: Apache-2.0
#include "reference_arguments.h"

#include <CLI/CLI.hpp>

#include "choices.h"
#include "numbers.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {

void ReferenceArguments::add_to(CLI::App& app) {
    app.add_option("--samples", samples, "n x n rays per pixel (default 1; 2 for --look solid)")
        ->type_name("N")
        ->transform(whole_number(1, 16));
    app.add_option("--tolerance-image", image_tolerance,
                   "dense, without --levels: raise the level until the RMS of the picture's change is less (default 1e-3)")
        ->type_name("RMS")
        ->transform(positive_number());
    app.add_option("--order", order,
                   "pt: how the tetrahedra are sorted: topological (by shared faces, the default), centroid, "
                   "lists (one per pixel) or havs (faces by centroid, then a k-buffer per pixel)")
        ->type_name("NAME")
        ->check(offered(names_of<ProjectedOrder>()));
    app.add_option("--kbuffer", kbuffer, "havs: entries of the k-buffer (default 6)")
        ->type_name("K")
        ->transform(whole_number(1, 65536));
    app.add_option("--lod", lod,
                   "splat: merge kernels as long as they are narrower than so many pixels, such as 2 (default 0: never); "
                   "havs: the fraction of the interior faces that is drawn (default 1)")
        ->type_name("PIXELS|F")
        ->transform(not_negative_number());
}

ProjectedOrder ReferenceArguments::projected_order() const {
    return named<ProjectedOrder>(order, "--order");
}

ProjectedOptions ReferenceArguments::projected_options() const {
    const ProjectedOptions options{
        .order = projected_order(), .kbuffer = kbuffer, .lod = lod.value_or(1), .samples = samples, .clip = clip};
    if (lod && *lod != 1 && options.order != ProjectedOrder::Havs)
        throw Error(ErrorCode::InvalidInput, "only --order havs leaves faces out", "--lod");
    if (options.lod > 1) throw Error(ErrorCode::InvalidInput, text("the fraction of faces is ", *lod), "--lod", "0 to 1");
    return options;
}

}  // namespace subvol::cli
