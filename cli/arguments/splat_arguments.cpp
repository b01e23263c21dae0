// SPDX-License-Identifier: Apache-2.0
#include "splat_arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>

#include "options.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol::cli {

std::vector<Option> SplatArguments::described() {
    std::vector<Option> all = options_of(chosen);
    std::ranges::move(options_of(static_cast<PictureChoices&>(*this)), std::back_inserter(all));
    return all;
}

void SplatArguments::add_to(CLI::App& app) {
    add_options(app, described());
    const auto refuse_sums = [](const std::string&, const std::string& option) {
        throw Error(ErrorCode::InvalidInput, "sheets are always summed in floats; parts, ranks and bricks have the same bits",
                    option, "leave it out; --backend cpu where a GPU would draw otherwise");
    };
    add_option(app, Option("sheet-sums", WordValue{[] { return std::string(); }, refuse_sums}))->group("");
}

SplatOptions SplatArguments::options() const {
    SplatOptions options = chosen;
    options.normalized = !plain_sums;
    if (shade) options.shading = Shading{};
    return options;
}

}  // namespace subvol::cli
