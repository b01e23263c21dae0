// SPDX-License-Identifier: Apache-2.0
#include "splat_arguments.h"

#include <CLI/CLI.hpp>

#include "options.h"
#include "subvol/error.h"

namespace subvol::cli {

void SplatArguments::add_to(CLI::App& app) {
    add_options(app, options_of(chosen));
    add_option(app,
               Option("shade", shade).help("splat: light on surfaces of equal value, from the eye and from the upper left"));
    add_option(app, Option("color-field", color_field)
                        .help("NAME", "splat: take the colours from this field; opacities stay those of --field"));
    add_option(app,
               Option("plain-sums", plain_sums).help("splat: add kernels up without dividing by the sum of their weights"));
    const auto refuse_sums = [](const std::string&) {
        throw Error(ErrorCode::InvalidInput, "sheets are always summed in floats; parts, ranks and bricks have the same bits",
                    "--sheet-sums", "leave it out; --backend cpu where a GPU would draw otherwise");
    };
    app.add_option_function<std::string>("--sheet-sums", refuse_sums, "removed")->group("");
}

SplatOptions SplatArguments::options() const {
    SplatOptions options = chosen;
    options.normalized = !plain_sums;
    if (shade) options.shading = Shading{};
    return options;
}

}  // namespace subvol::cli
