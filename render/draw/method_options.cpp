// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <string>

#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/picture_maker.h"

namespace subvol {
namespace {

void check_light(const PictureStyle& style, OptionNames names) {
    const bool computes_light = draws_kernels(style.method) || style.method == Method::Grid;
    if (computes_light || !is_lit(style.look.look) || style.look.look == Look::Solid) return;
    throw Error(ErrorCode::InvalidInput, "method " + std::string(name_of(style.method)) + " lights the boundary only",
                option_name("look", names) + (names == OptionNames::Flags ? " " : "=") + std::string(name_of(style.look.look)),
                "use method splat or sheets, or the colour map isosurface for surfaces without light");
}

/// Kernels take any number of pixels; pt takes the fraction of the faces that only one of its orders can leave out.
void check_lod(const MethodOptions& options) {
    if (!options.lod || options.style.method != Method::Projected) return;
    const std::string where = option_name("lod", options.names);
    if (*options.lod > 1) {
        throw Error(ErrorCode::InvalidInput, "the fraction of faces is " + detail::number_text(*options.lod), where, "0 to 1");
    }
    if (options.order != ProjectedOrder::Havs) {
        throw Error(ErrorCode::InvalidInput,
                    "has no effect without " + option_name("order", options.names) + " havs: only this order leaves faces out",
                    where);
    }
}

/// Within a time limit the kernels follow from the time.
void check_time(const MethodOptions& options) {
    if (!options.seconds || !draws_kernels(options.style.method)) return;
    const KernelOptions& kernels = options.kernels;
    const char* const other = kernels.levels                              ? "levels"
                              : kernels.reduce_rmse > 0                   ? "reduce"
                              : kernels.visible || options.drop_invisible ? "threshold"
                              : kernels.sample.footprint                  ? "footprint"
                                                                          : nullptr;
    if (other == nullptr) return;
    throw Error(ErrorCode::InvalidInput, "has no effect with " + option_name("seconds", options.names),
                option_name(other, options.names), "leave one of them out");
}

}  // namespace

std::vector<Option> options_of(MethodOptions& options) {
    return {Option("samples", options.style.samples)
                .between(1, 16)
                .help("N", "n x n rays per pixel (default 1; 2 for --look solid)"),
            Option("tolerance-image", options.image_tolerance)
                .positive()
                .called("image_tolerance")
                .help("RMS",
                      "how far colours may be off: splat and sheets take as many sheets as that needs (default .001); dense, "
                      "without --levels, draws level after level until the picture changes by less")
                .not_with("levels")
                .not_with("sheets"),
            Option("order", options.order)
                .help("NAME",
                      "pt: how the tetrahedra are sorted: topological (by shared faces), centroid, lists (one per pixel) or "
                      "havs (faces by centroid, then a k-buffer per pixel)"),
            Option("kbuffer", options.kbuffer)
                .between(1, 65536)
                .help("K", "havs: entries of the k-buffer")
                .only_with("order", {"havs"})
                .or_with("seconds"),
            Option("lod", options.lod)
                .not_negative()
                .help("PIXELS|F",
                      "splat: merge kernels as long as they are narrower than so many pixels, such as 2 (default 0: never); "
                      "havs: the fraction of the interior faces that is drawn (default 1)"),
            Option("seconds", options.seconds)
                .positive()
                .help("S",
                      "the best picture within this time; splat: first coarse, then with the mesh sampled for the view; pt: "
                      "first the faces of the boundary, then more and more of those inside; kernels follow from the time then, "
                      "not from --levels, --reduce, --threshold or --footprint")
                .instead_of({"turntable", "order", "lod"}),
            Option("memory", options.memory_bytes)
                .bytes()
                .help("BYTES",
                      "of bricks: what kernels or cells take while a part of the picture is drawn; of .svk files with --lod: "
                      "what is kept for the next frame (default 1G)")};
}

std::vector<Option> options_of(PictureChoices& choices) {
    return {
        Option("shade", choices.shade)
            .help("splat: light on surfaces of equal value, from the eye and from the upper left")
            .not_with("look", {"solid", "isosurface"}),
        Option("color-field", choices.color_field)
            .help("NAME", "splat: take the colours from this field; opacities stay those of --field"),
        Option("plain-sums", choices.plain_sums).help("splat: add kernels up without dividing by the sum of their weights")};
}

MethodOptions PictureSettings::chosen() const {
    MethodOptions made = options;
    made.kernels.sample.scheme = refinement.scheme;
    made.kernels.levels = levels;
    made.splat.normalized = !choices.plain_sums;
    if (choices.shade) made.splat.shading = Shading{};
    return made;
}

std::vector<Option> options_of(PictureSettings& settings) {
    std::vector<Option> all = options_of(settings.refinement);
    all.back().value = &settings.levels;
    all.back().help("L", "draw the refined mesh of this level (default for tets and pt: 1, if large 0; others: the limit)");
    for (auto more : {options_of(settings.options.kernels.sample), options_of(settings.options.splat),
                      options_of(settings.options), options_of(settings.choices), options_of(settings.options.style.clip)})
        std::ranges::move(more, std::back_inserter(all));
    std::erase_if(all, [](const Option& option) { return option.name == "boundary-levels"; });  // they follow from the samples
    return all;
}

std::vector<Option> options_of(PictureSettings& settings, Method method) {
    std::vector<Option> all = options_of(settings);
    std::erase_if(all, [&](const Option& option) { return !reads(method, BodyKind::Mesh, option.name); });
    return all;
}

void validate(const PictureStyle& style, OptionNames names) {
    check_light(style, names);
}

void validate(const MethodOptions& options) {
    check_options(options);
    check_options(options.splat);
    validate(options.style, options.names);
    check_lod(options);
    check_time(options);
}

}  // namespace subvol
