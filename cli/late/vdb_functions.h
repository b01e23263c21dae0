// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/detail/vdb_file.h"
#include "subvol/grid_error.h"
#include "subvol/grid_surface.h"
#include "subvol/join_grids.h"
#include "subvol/nanovdb.h"
#include "subvol/rasterize.h"
#include "subvol/spread_vectors.h"
#include "subvol/vdb_contents.h"
#include "subvol/vdb_grid.h"
#include "subvol/vdb_points.h"
#include "subvol/vdb_sample.h"

namespace subvol::cli {

/// The calls of subvol::vdb that the command makes, as its module has them: `vdb().rasterize(…)`. Their headers say what they
/// do. They throw what those throw: the type `Error` exists twice, in the command and in the module, but with one name, and by
/// that it is caught.
struct VdbFunctions {
    std::vector<VdbGrid> (*rasterize)(const HexMesh&, std::span<const std::string>, const RasterizeOptions&);
    LimitGrids (*rasterize_limit)(const HexMesh&, std::span<const std::string>, const RasterizeOptions&);
    void (*check_voxels)(const HexMesh&, const RasterizeOptions&);
    RefinementTables (*rasterization_tables)(const HexMesh&, const RasterizeOptions&);
    PartsReport (*rasterize_parts)(const MeshSource&, std::span<const std::string>, const RasterizeOptions&, std::size_t,
                                   const std::function<void(GridPart)>&);
    GridShare (*rasterize_share)(const MeshSource&, std::span<const std::string>, const RasterizeOptions&, const Share&);
    std::vector<VdbGrid> (*rasterize_points)(const RbfVolume&, std::span<const std::size_t>, const RasterizeOptions&);
    VdbGrid (*sample_at_voxels)(const VdbGrid&, const std::string&,
                                const std::function<std::vector<double>(std::span<const Vec3>)>&);
    GridError (*grid_error)(const VdbGrid&, const HexMesh&, std::string_view, const GridErrorOptions&);
    VdbGrid (*spread_vectors)(const VdbGrid&, int);

    void (*write_vdb)(const std::filesystem::path&, std::span<const VdbGrid>, VdbCompression);
    void (*write_vdb_file)(const detail::AtomicFile&, const std::filesystem::path&, std::span<const VdbGrid>, VdbCompression);
    std::vector<VdbGrid> (*read_vdb)(const std::filesystem::path&);
    Surface (*grid_surface)(const VdbGrid&, std::optional<double>);
    LabelGrid (*labels_of_grid)(const VdbGrid&);
    bool (*has_nanovdb)();
    void (*write_nanovdb)(const std::filesystem::path&, std::span<const VdbGrid>);

    void (*write_vdb_points)(const std::filesystem::path&, const RbfVolume&, const VdbPointsOptions&);
    RbfVolume (*read_vdb_points)(const std::filesystem::path&);
    bool (*holds_vdb_points)(const std::filesystem::path&);
    VoxelSampleResult (*sample_rbf_points)(const VdbGrid&, const VoxelSampleOptions&);

    VdbContents (*read_vdb_contents)(const std::filesystem::path&);
    VdbGrid (*scalar_of)(const VdbGrid&, std::optional<int>, const std::string&);
    void (*clamp_voxels)(VdbGrid&, const FieldRange&);
    void (*prune_voxels)(VdbGrid&, double);

    VdbGrid (*join_grids)(std::vector<VdbGrid>);
    std::optional<std::string> (*text_of_grid)(const VdbGrid&, const std::string&);
    void (*set_text_of_grid)(VdbGrid&, const std::string&, const std::optional<std::string>&);
    void (*store_in_half)(VdbGrid&, bool);
    std::string (*bytes_of_grids)(std::span<const VdbGrid>);
    std::vector<VdbGrid> (*grids_from_bytes)(const std::string&);
    std::uint64_t (*hash_of_grid)(const VdbGrid&);

    GridDifference (*compare_voxels)(const VdbGrid&, const VdbGrid&);
    void (*remove_unfinished_files)() noexcept;
};

/// The module, which the first call loads: OpenVDB's symbols take longer to resolve than the command takes to start.
///
/// throws: Error(MissingCapability) if it is not there
[[nodiscard]] const VdbFunctions& vdb();

}  // namespace subvol::cli
