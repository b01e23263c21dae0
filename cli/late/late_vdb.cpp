// SPDX-License-Identifier: Apache-2.0
// The command's subvol::vdb: each call loads the module subvol_openvdb.so, if it is the first, and continues there. OpenVDB's
// symbols take longer to resolve than the command takes to start.
#include "subvol/detail/module.h"
#include "subvol/detail/unfinished_files.h"
#include "vdb_functions.h"

namespace {

const subvol::cli::VdbFunctions& vdb() {
    using Entry = const subvol::cli::VdbFunctions* (*)();
    static const subvol::cli::VdbFunctions& functions = []() -> const subvol::cli::VdbFunctions& {
        const auto& loaded =
            *reinterpret_cast<Entry>(subvol::detail::load_module("openvdb", "reading, writing or computing grids"))();
        subvol::detail::remove_unfinished_files_of(loaded.remove_unfinished_files);
        return loaded;
    }();
    return functions;
}

}  // namespace

// Only the module knows what is freed.
void subvol::detail::FreeVdbData::operator()(VdbData* data) const noexcept {
    vdb().free(data);
}

namespace subvol {

using Path = std::filesystem::path;
using Grids = std::vector<VdbGrid>;

Grids rasterize(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options) {
    return vdb().rasterize(mesh, fields, options);
}

void check_voxels(const HexMesh& mesh, const RasterizeOptions& options) {
    vdb().check_voxels(mesh, options);
}

RefinementTables rasterization_tables(const HexMesh& mesh, const RasterizeOptions& options) {
    return vdb().rasterization_tables(mesh, options);
}

void rasterize_parts(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options,
                     std::size_t memory_bytes, const std::function<void(GridPart)>& take) {
    vdb().rasterize_parts(mesh, fields, options, memory_bytes, take);
}

BlockGrids rasterize_block(const HexMesh& part, std::span<const std::string> fields, const RasterizeOptions& options,
                           const VoxelCubes& block) {
    return vdb().rasterize_block(part, fields, options, block);
}

Grids rasterize_share(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options, int part,
                      int of) {
    return vdb().rasterize_share(mesh, fields, options, part, of);
}

Grids rasterize_points(const RbfVolume& volume, std::span<const std::size_t> channels, const RasterizeOptions& options) {
    return vdb().rasterize_points(volume, channels, options);
}

VdbGrid sample_at_voxels(const VdbGrid& where, const std::string& name,
                         const std::function<std::vector<double>(std::span<const Vec3>)>& field) {
    return vdb().sample_at_voxels(where, name, field);
}

GridError grid_error(const VdbGrid& grid, const HexMesh& mesh, std::string_view field, const GridErrorOptions& options) {
    return vdb().grid_error(grid, mesh, field, options);
}

VdbGrid spread_vectors(const VdbGrid& grid, int layers) {
    return vdb().spread_vectors(grid, layers);
}

void write_vdb(const Path& path, std::span<const VdbGrid> grids, VdbCompression compression) {
    vdb().write_vdb(path, grids, compression);
}

void detail::write_vdb(const AtomicFile& file, const Path& path, std::span<const VdbGrid> grids, VdbCompression compression) {
    vdb().write_vdb_file(file, path, grids, compression);
}

Grids read_vdb(const Path& path) {
    return vdb().read_vdb(path);
}

bool has_nanovdb() {
    return vdb().has_nanovdb();
}

void write_nanovdb(const Path& path, std::span<const VdbGrid> grids) {
    vdb().write_nanovdb(path, grids);
}

void write_vdb_points(const Path& path, const RbfVolume& volume, const VdbPointsOptions& options) {
    vdb().write_vdb_points(path, volume, options);
}

RbfVolume read_vdb_points(const Path& path) {
    return vdb().read_vdb_points(path);
}

bool holds_vdb_points(const Path& path) {
    return vdb().holds_vdb_points(path);
}

VoxelSampleResult sample_rbf_points(const VdbGrid& grid, const VoxelSampleOptions& options) {
    return vdb().sample_rbf_points(grid, options);
}

VdbContents read_vdb_contents(const Path& path) {
    return vdb().read_vdb_contents(path);
}

VdbGrid scalar_of(const VdbGrid& grid, std::optional<int> component, const std::string& name) {
    return vdb().scalar_of(grid, component, name);
}

void clamp_voxels(VdbGrid& grid, const FieldRange& range) {
    vdb().clamp_voxels(grid, range);
}

VdbGrid join_grids(Grids parts) {
    return vdb().join_grids(std::move(parts));
}

std::optional<std::string> text_of_grid(const VdbGrid& grid, const std::string& name) {
    return vdb().text_of_grid(grid, name);
}

void set_text_of_grid(VdbGrid& grid, const std::string& name, const std::optional<std::string>& text) {
    vdb().set_text_of_grid(grid, name, text);
}

void store_in_half(VdbGrid& grid, bool half) {
    vdb().store_in_half(grid, half);
}

std::string detail::bytes_of_grids(std::span<const VdbGrid> grids) {
    return vdb().bytes_of_grids(grids);
}

Grids detail::grids_from_bytes(const std::string& bytes) {
    return vdb().grids_from_bytes(bytes);
}

std::uint64_t hash_of_grid(const VdbGrid& grid) {
    return vdb().hash_of_grid(grid);
}

GridDifference compare_voxels(const VdbGrid& a, const VdbGrid& b) {
    return vdb().compare_voxels(a, b);
}

VdbGrid::~VdbGrid() = default;
VdbGrid::VdbGrid(VdbGrid&&) noexcept = default;
VdbGrid& VdbGrid::operator=(VdbGrid&&) noexcept = default;

const GridReport& VdbGrid::report() const {
    return vdb().report(*this);
}

std::optional<double> VdbGrid::value(const Vec3& x) const {
    return vdb().value(*this, x);
}

std::unique_ptr<Voxels> VdbGrid::voxels() const {
    return vdb().voxels(*this);
}

}  // namespace subvol
