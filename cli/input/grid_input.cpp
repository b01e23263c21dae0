// SPDX-License-Identifier: Apache-2.0
#include "grid_input.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {

std::string extension_of(const std::string& file) {
    std::string extension = std::filesystem::path(file).extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

bool is_vdb_file(const std::string& input) {
    return extension_of(input) == ".vdb";
}

VdbGrid load_grid(const std::string& input, const CommonOptions& options, Report& report) {
    report["input"] = input;
    if (!is_vdb_file(input)) {
        throw Error(ErrorCode::InvalidInput, "is not a grid", input, "a .vdb file, as `subvol vdb` makes of a mesh");
    }
    std::vector<VdbGrid> grids = report.timed("read", [&] { return read_vdb(input); });
    auto found = grids.begin();
    if (options.field) {
        found = std::ranges::find(grids, *options.field, [](const VdbGrid& grid) { return grid.report().name; });
        if (found == grids.end()) {
            std::vector<std::string> names;
            for (const VdbGrid& grid : grids) names.push_back(grid.report().name);
            throw Error(ErrorCode::InvalidInput, "there is no float grid '" + *options.field + "'", input,
                        "it has: " + join(names));
        }
    }
    const GridReport& grid = found->report();
    if (grid.active_voxels == 0) throw Error(ErrorCode::InvalidInput, "the grid has no active voxels", input);
    report["field"] = grid.name;
    report["active_voxels"] = grid.active_voxels;
    report["voxel_size"] = grid.voxel_size_world;
    return std::move(*found);
}

Box box_of(const GridReport& grid) {
    return {grid.bounds.lower - 0.5 * grid.voxel_size_world, grid.bounds.upper + 0.5 * grid.voxel_size_world};
}

}  // namespace subvol::cli
