// SPDX-License-Identifier: Apache-2.0
// The module subvol_openvdb.so: subvol::vdb, and OpenVDB with it.
#include "subvol/detail/atomic_file.h"
#include "subvol/version.h"
#include "vdb_functions.h"

extern "C" {
extern const char subvol_module_version[];
const char subvol_module_version[] = SUBVOL_VERSION;

const subvol::cli::VdbFunctions* subvol_openvdb() {
    using namespace subvol;
    static const cli::VdbFunctions functions{
        .rasterize = &rasterize,
        .rasterize_limit = &rasterize_limit,
        .check_voxels = &check_voxels,
        .rasterization_tables = &rasterization_tables,
        .rasterize_parts = &rasterize_parts,
        .rasterize_share = &rasterize_share,
        .rasterize_points = &rasterize_points,
        .sample_at_voxels = &sample_at_voxels,
        .grid_error = &grid_error,
        .spread_vectors = &spread_vectors,
        .write_vdb = &write_vdb,
        .write_vdb_file = &detail::write_vdb,
        .read_vdb = &read_vdb,
        .grid_surface = &grid_surface,
        .labels_of_grid = &labels_of_grid,
        .has_nanovdb = &has_nanovdb,
        .write_nanovdb = &write_nanovdb,
        .write_vdb_points = &write_vdb_points,
        .read_vdb_points = &read_vdb_points,
        .holds_vdb_points = &holds_vdb_points,
        .sample_rbf_points = &sample_rbf_points,
        .read_vdb_contents = &read_vdb_contents,
        .scalar_of = &scalar_of,
        .clamp_voxels = &clamp_voxels,
        .prune_voxels = &prune_voxels,
        .join_grids = &join_grids,
        .text_of_grid = &text_of_grid,
        .set_text_of_grid = &set_text_of_grid,
        .store_in_half = &store_in_half,
        .bytes_of_grids = &detail::bytes_of_grids,
        .grids_from_bytes = &detail::grids_from_bytes,
        .hash_of_grid = &hash_of_grid,
        .compare_voxels = &compare_voxels,
        .remove_unfinished_files = &detail::remove_unfinished_files,
    };
    return &functions;
}
}
