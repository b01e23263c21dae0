// SPDX-License-Identifier: Apache-2.0
#include "splat_arguments.h"

#include <CLI/CLI.hpp>

#include "choices.h"
#include "numbers.h"

namespace subvol::cli {

void SplatArguments::add_to(CLI::App& app) {
    app.add_option("--backend", backend, "where to splat: auto (default: a GPU, else the CPU), gl, cpu")
        ->type_name("NAME")
        ->check(offered(names_of<SplatMethod>()));
    app.add_option("--device", device, "the OpenGL device's number in `info --gl` (default: the first GPU)")
        ->type_name("N")
        ->transform(whole_number(0, 1000));
    app.add_option("--sheets", sheets, "splat: number of planes over the volume's depth (default: as many as the kernels need)")
        ->type_name("N")
        ->transform(whole_number(2, 65536));
    app.add_flag("--shade", shade, "splat: light on surfaces of equal value, from the eye and from the upper left");
    app.add_flag("--shadows", shadows, "splat: the volume shadows itself from the light at the upper left");
    app.add_option("--ambient-occlusion", ambient_occlusion,
                   "splat: darken hollows that are narrower than this part of the box's diagonal, such as .1")
        ->type_name("R")
        ->transform(number_in(0.0, 1.0));
    app.add_option("--color-field", color_field, "splat: take the colours from this field; opacities stay those of --field")
        ->type_name("NAME");
    app.add_flag("--plain-sums", plain_sums, "splat: add kernels up without dividing by the sum of their weights");
    const auto refuse_sums = [](const std::string&) {
        throw Error(ErrorCode::InvalidInput, "sheets are always summed in floats; parts, ranks and bricks have the same bits",
                    "--sheet-sums", "leave it out; --backend cpu where a GPU would draw otherwise");
    };
    app.add_option_function<std::string>("--sheet-sums", refuse_sums, "removed")->group("");
    app.add_option("--seconds", seconds,
                   "the best picture within this time; splat: first coarse, then with the mesh sampled for the view; "
                   "pt: first the faces of the boundary, then more and more of those inside")
        ->type_name("S")
        ->transform(positive_number())
        ->excludes("--turntable")
        ->excludes("--levels")
        ->excludes("--reduce")
        ->excludes("--threshold")
        ->excludes("--footprint");
}

SplatOptions SplatArguments::options() const {
    SplatOptions options{.method = named<SplatMethod>(backend, "--backend"),
                         .device = device,
                         .sheets = sheets,
                         .normalized = !plain_sums,
                         .shadows = shadows,
                         .ambient_occlusion = ambient_occlusion};
    if (shade) options.shading = Shading{};
    return options;
}

}  // namespace subvol::cli
