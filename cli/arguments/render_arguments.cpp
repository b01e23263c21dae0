// SPDX-License-Identifier: Apache-2.0
#include "render_arguments.h"

#include <CLI/CLI.hpp>

#include "choices.h"
#include "numbers.h"
#include "text.h"

namespace subvol::cli {

GivenOptions given_options(const CLI::App& app) {
    return [&app](std::string_view name) -> std::optional<std::string> {
        const CLI::Option* option = app.get_option_no_throw("--" + std::string(name));
        if (option == nullptr || option->count() == 0) return std::nullopt;
        return join(option->results());
    };
}

void RenderArguments::add_to(CLI::App& app) {
    app.add_option("--method", method_name_,
                   "splat (kernels, the default), sheets (the same by OpenGL sheet buffers), "
                   "footprints (kernels coloured first), tets (rays through tetrahedra), "
                   "pt (the same tetrahedra projected by OpenGL), dense (rays through the limit's cells) or "
                   "grid (rays through a .vdb file's voxels)")
        ->type_name("NAME")
        ->check(offered(names_of<Method>()));
    picture.add_to(app);
    clip.add_to(app);
    add_references_to(app);
    sample.add_to(app);
    refine.add_to(app, "draw the refined mesh of this level (default for tets and pt: 1; for the others: the limit)");
    splat.add_to(app);
    app.add_option("--memory", memory_bytes_,
                   "of bricks: what kernels or cells take while a part of the picture is drawn; of .svk files with --lod: "
                   "what is kept for the next frame (default 1G)")
        ->type_name("BYTES")
        ->transform(byte_count());
}

void RenderArguments::add_references_to(CLI::App& app) {
    app.add_option("--samples", samples, "n x n rays per pixel (default 1; 2 for --look solid)")
        ->type_name("N")
        ->transform(whole_number(1, 16));
    app.add_option("--tolerance-image", image_tolerance_,
                   "dense, without --levels: raise the level until the RMS of the picture's change is less (default 1e-3)")
        ->type_name("RMS")
        ->transform(positive_number());
    app.add_option("--order", order_,
                   "pt: how the tetrahedra are sorted: topological (by shared faces, the default), centroid, "
                   "lists (one per pixel) or havs (faces by centroid, then a k-buffer per pixel)")
        ->type_name("NAME")
        ->check(offered(names_of<ProjectedOrder>()));
    app.add_option("--kbuffer", kbuffer_, "havs: entries of the k-buffer (default 6)")
        ->type_name("K")
        ->transform(whole_number(1, 65536));
    app.add_option("--lod", lod,
                   "splat: merge kernels as long as they are narrower than so many pixels, such as 2 (default 0: never); "
                   "havs: the fraction of the interior faces that is drawn (default 1)")
        ->type_name("PIXELS|F")
        ->transform(not_negative_number());
}

void RenderArguments::settle(BodyKind input, const CLI::App& app) {
    method = named<Method>(method_name_, "--method");
    body = input;
    const bool is_mesh = body == BodyKind::Mesh;
    if (is_mesh) tets = TetRefinement(refine);
    if (tets.asked()) body = BodyKind::Tets;
    picture.settle_look((is_mesh || body == BodyKind::Bricks) && !splat.shade);
    check_method(method, body);
    check_options(bit(method), body, given_options(app));
    validate(method_options({{0, 0, 0}, {1, 1, 1}}, {0, 1}, nullptr));
    picture.check();
}

MethodOptions RenderArguments::method_options(const Box& box, const Range& field, Progress* progress) const {
    return {.style = {.method = method, .look = picture.look_options(field), .samples = samples, .clip = clip.clip()},
            .kernels = sample.kernel_options(box, refine.options(0, progress), refine.levels),
            .drop_invisible = sample.drops_invisible(),
            .splat = splat.options(),
            .order = named<ProjectedOrder>(order_, "--order"),
            .kbuffer = kbuffer_,
            .image_tolerance = image_tolerance_,
            .lod = lod,
            .seconds = splat.seconds,
            .memory_bytes = memory_bytes_};
}

}  // namespace subvol::cli
