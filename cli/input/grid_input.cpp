// SPDX-License-Identifier: Apache-2.0
#include "grid_input.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "subvol/detail/near_name.h"
#include "subvol/error.h"
#include "text.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

std::string held(const VdbContents& contents) {
    std::vector<std::string> names;
    for (const VdbGrid& grid : contents.grids) names.push_back(grid.report().name);
    for (const auto& other : contents.others) names.push_back(other.name + " (" + other.type + ")");
    return names.empty() ? "" : "it has: " + join(names);
}

}  // namespace

std::string extension_of(const std::string& file) {
    std::string extension = std::filesystem::path(file).extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

bool is_vdb_file(const std::string& input) {
    return extension_of(input) == ".vdb";
}

VdbGrid select_grid(const VdbContents& contents, const std::optional<std::string>& name, const std::string& input) {
    const auto& grids = contents.grids;
    if (!name) {
        for (const char* kind : {"float", "vector"}) {
            for (const VdbGrid& grid : grids) {
                if (grid.report().kind == kind) return vdb().scalar_of(grid, std::nullopt, grid.report().name);
            }
        }
        throw Error(ErrorCode::InvalidInput, "holds no grid of floats or vectors", input, held(contents));
    }
    for (const VdbGrid& grid : grids) {
        if (grid.report().name == *name) return vdb().scalar_of(grid, std::nullopt, *name);
    }
    const std::size_t dot = name->rfind('.');
    if (dot != std::string::npos && dot + 2 == name->size()) {
        const std::size_t letter = std::string("xyz012").find(name->back());
        for (const VdbGrid& grid : grids) {
            if (letter != std::string::npos && grid.report().kind == "vector" && grid.report().name == name->substr(0, dot))
                return vdb().scalar_of(grid, static_cast<int>(letter % 3), *name);
        }
    }
    std::vector<std::string> names;
    for (const VdbGrid& grid : grids) names.push_back(grid.report().name);
    throw Error(ErrorCode::InvalidInput, "there is no grid '" + *name + "'" + detail::did_you_mean(*name, names), input,
                held(contents));
}

namespace {

/// choose: the grid among the contents of the file
template <class Choose>
WithFacts<VdbGrid> load_chosen(const std::string& input, Progress* progress, const Choose& choose) {
    Facts facts;
    facts["input"] = input;
    if (!is_vdb_file(input)) {
        throw Error(ErrorCode::InvalidInput, "is not a grid", input, "a .vdb file, as `subvol vdb` makes of a mesh");
    }
    VdbGrid found = choose(facts.timed(progress, "read", [&] { return vdb().read_vdb_contents(input); }));
    const GridReport& grid = found.report();
    if (grid.active_voxels == 0) throw Error(ErrorCode::InvalidInput, "the grid has no active voxels", input);
    facts["field"] = grid.name;
    facts["active_voxels"] = grid.active_voxels;
    facts["voxel_size"] = grid.voxel_size_world;
    return {std::move(found), std::move(facts)};
}

}  // namespace

WithFacts<VdbGrid> load_grid(const std::string& input, const CommonOptions& options, Progress* progress) {
    return load_chosen(input, progress,
                       [&](const VdbContents& contents) { return select_grid(contents, options.field, input); });
}

WithFacts<VdbGrid> load_grid_or_labels(const std::string& input, const CommonOptions& options, bool labels,
                                       Progress* progress) {
    return load_chosen(input, progress, [&](VdbContents contents) {
        bool others = false;
        VdbGrid* integers = nullptr;
        for (VdbGrid& grid : contents.grids) {
            if (options.field && grid.report().name != *options.field) continue;
            const std::string& kind = grid.report().kind;
            others |= kind == "float" || kind == "vector";
            if (kind == "integer" && integers == nullptr) integers = &grid;
        }
        if (integers != nullptr && (labels || !others)) return std::move(*integers);
        VdbGrid found = select_grid(contents, options.field, input);  // also refuses names that are not there
        if (!labels) return found;
        throw Error(ErrorCode::InvalidInput, "has no grid of integers, whose voxels have labels", input, held(contents));
    });
}

Box box_of(const GridReport& grid) {
    return {grid.bounds.lower - 0.5 * grid.voxel_size_world, grid.bounds.upper + 0.5 * grid.voxel_size_world};
}

}  // namespace subvol::cli
