// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bind.h"
#include "subvol/rasterize.h"

namespace subvol::python {

/// The keywords of rasterize() and write_vdb().
struct GivenGrids {
    SchemeOptions scheme{};
    std::optional<int> levels{};         ///< none: the limit
    std::optional<double> voxel_size{};  ///< none: as the resolution says
    RasterizeOptions grids{};
    std::optional<std::string> sdf{};  ///< none: no level set
    LevelSetOptions level_set{};

    [[nodiscard]] RasterizeOptions chosen() const {
        RasterizeOptions options = grids;
        options.voxel_size_world = voxel_size.value_or(0);
        options.refine = {.scheme = scheme, .levels = levels.value_or(0)};
        if (!sdf) return options;
        options.level_set = level_set;
        if (!sdf->empty()) options.level_set->name = *sdf;
        return options;
    }
};

[[nodiscard]] inline std::vector<Option> options_of(GivenGrids& given) {
    std::vector<Option> all = scheme_and(given.scheme, options_of(given.grids));
    RefineOptions any;
    Option levels("levels", given.levels);
    const int most = static_cast<int>(options_of(any).back().range.most);
    all.push_back(levels.between(0, most).help("L", "the trilinear cells of this level instead of the limit"));
    for (Option& option : all) {
        if (option.name != "voxel-size") continue;
        const std::string sentence = option.sentence;
        option = Option("voxel-size", given.voxel_size).positive().help(option.about, sentence);
    }
    for (Option& option : options_of(given.level_set)) {
        if (option.name == "sdf") option.value = &given.sdf;
        all.push_back(std::move(option));
    }
    return all;
}

}  // namespace subvol::python
