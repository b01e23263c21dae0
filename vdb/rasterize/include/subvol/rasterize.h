// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/limit_level.h"
#include "subvol/mesh_source.h"
#include "subvol/option.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"
#include "subvol/refine.h"
#include "subvol/share.h"
#include "subvol/vdb_grid.h"

namespace subvol {

struct LevelSetOptions {
    std::string name = "sdf";
    double half_width_voxels = 3;  ///< voxels up to this distance on both sides of the surface are active; 1 to 1000
};

/// The three pointers are not owned; what they point to must live as long as the call that gets the options.
struct RasterizeOptions {
    double voxel_size_world = 0;  ///< above 0, or 0 to use `resolution`
    int resolution = 200;         ///< voxels along the longest side of the bounding box
    /// Null, or a grid whose voxels are used instead of `voxel_size_world` and `resolution`; its transform must be linear.
    const VdbGrid* like = nullptr;
    /// What is rasterized: the trilinear cells of the refined mesh (levels 0: of the mesh itself); only some control cells at a
    /// time are refined.
    RefineOptions refine{.levels = 0};
    bool on_limit = false;  ///< the vertices of the refined mesh are moved to the limit; else they stay in place
    /// Null, or the cells that approximate the limit; they replace refine.levels and on_limit.
    const LimitCells* limit = nullptr;
    /// Null, or the result of `rasterization_tables` for a mesh of the same cells: nothing of the refinement is computed again,
    /// but the whole refined mesh is in memory. The grids are the same; with a limit, they are those of cells whose nodes all
    /// have the finest level of the limit.
    const RefinementTables* tables = nullptr;
    /// For a mesh in pieces: the cells that approximate the limit replace refine.levels and on_limit; they are found for each
    /// block of voxels.
    bool find_limit = false;
    /// For a mesh in pieces: about the most that a block of voxels and the cells about it take.
    std::size_t block_bytes = std::size_t{1} << 30;
    bool half = false;          ///< store floats in 16 bits
    bool cell_numbers = false;  ///< adds a grid of integers named "cell": the control cell that contains the voxel's centre
    /// For a mesh in memory: for each cell its number in the grid of cell numbers, or kNone: it is not rasterized, and only
    /// shapes the limit of the others, which end at it sharply, as of `part_with_halo`. The box is that of the others. Empty:
    /// all cells, by their places.
    std::span<const Index> cells{};
    bool mask = false;  ///< adds a grid of bits named "mask": where the volume is
    /// Adds a grid of floats named "coverage": the part of each voxel that the volume fills, by 4³ samples; active where it is
    /// above zero.
    bool coverage = false;
    /// Adds a grid of floats: the distance to the volume's boundary in world units, exact in a narrow band about it, negative
    /// at centres inside the volume; beyond the band ± its half width, inactive.
    std::optional<LevelSetOptions> level_set{};
    Box frame{};  ///< the box that named views of the grids show, which they store; empty: that of the mesh or the points
    std::string creator = "OpenSubVol";
    std::vector<std::pair<std::string, std::string>> metadata{};  ///< names and texts that are stored in every grid
    Progress* progress = nullptr;
};

/// In the header, so that programs which load this component when they need it know its options before.
[[nodiscard]] inline std::vector<Option> options_of(RasterizeOptions& options) {
    return {Option("voxel-size", options.voxel_size_world).positive().or_none().help("H", "edge of a voxel in world units"),
            Option("resolution", options.resolution)
                .between(1, 1 << 20)
                .help("N", "voxels along the longest side of the bounding box")
                .instead_of({"voxel-size"}),
            Option("half", options.half).help("store floats in 16 bits"),
            Option("cell-ids", options.cell_numbers).help("also write a grid: the number of the control cell"),
            Option("mask", options.mask).help("also write a grid: a mask of the volume"),
            Option("coverage", options.coverage).help("also write a grid: the part of each voxel that the volume fills")};
}

/// sdf, half-width
[[nodiscard]] inline std::vector<Option> options_of(LevelSetOptions& options) {
    constexpr double kMostWidth = 1000;
    return {
        Option("sdf", options.name)
            .help("[NAME]",
                  "also write a level set, named NAME or sdf: the distance to the boundary, negative inside, in a narrow band"),
        Option("half-width", options.half_width_voxels)
            .between(1, kMostWidth)
            .help("N", "the band's reach to either side, in voxels")
            .only_with("sdf")};
}

/// The box of the points of the cells that are rasterized.
[[nodiscard]] inline Box rasterized_box(const HexMesh& mesh, const RasterizeOptions& options) {
    if (options.cells.size() != mesh.cells.size()) return bounds(mesh);
    Box box;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        if (options.cells[c] == kNone) continue;
        for (const Index p : mesh.cells[c]) box.add(mesh.points[p]);
    }
    return box;
}

/// The edge of a voxel: of `like`, the one that is given, or as the resolution says for this box.
[[nodiscard]] inline double voxel_size_of(const Box& box, const RasterizeOptions& options) {
    if (options.like != nullptr) return options.like->report().voxel_size_world;
    if (options.voxel_size_world > 0) return options.voxel_size_world;
    const Vec3 size = box.size();
    return std::max({size.x, size.y, size.z}) / options.resolution;
}

/// Rasterizes attributes of a hexahedral mesh: cubic voxels, values at voxel centres, active where the centre lies inside the
/// mesh. A field of one channel becomes a grid of floats, one of three channels a grid of vectors; the first field, if it has
/// one channel, becomes a fog volume. Leaves that are full of one value become tiles.
///
/// A cell's tetrahedra (`split_cell`; those of refined cells start at the corner that is smallest in x, then y, then z) decide
/// which centres are inside; its trilinear map gives the values there. A centre on the boundary counts as if it were moved 1e-6
/// voxels up along all axes: a box that fits the voxels fills its volume exactly, and boxes that touch share none. Voxels that
/// only folded cells fill, outside the mesh's boundary, are removed. Where cells overlap, the control cell with the smallest
/// number determines the value. Parallel over bricks of leaves; the result is the same for any number of threads.
///
/// throws: Error(InvalidInput) if the mesh is not valid; if a field is missing, has two or more than three channels or does not
///         fit its float; if a level set has voxels that are not cubes or a half width out of range; if the voxel size is not
///         positive, is below OpenVDB's least of 1.45e-5, or gives more than 2·10⁹ voxels or indices beyond 2³⁰.
///         Error(Cancelled)
/// cost:   memory: the grids, and some 20 MB, or where the mesh is refined some 150 MB and twice the mesh
[[nodiscard]] std::vector<VdbGrid> rasterize(const HexMesh& mesh, std::span<const std::string> fields,
                                             const RasterizeOptions& options = {});

struct LimitGrids {
    std::vector<VdbGrid> grids;
    LimitCells limit;  ///< how fine the pieces of the limit were; without the pieces
};

/// Rasterizes the limit, as `rasterize` with the pieces of `limit_for_voxels`. They are filled as they are found, some thousand
/// cells at a time, so that never all of them are in memory: for meshes of many cells, small beside their voxels.
///
/// options: `limit`, `tables` and `on_limit` are not used; without coverage and a level set, for which pieces are needed twice
/// throws:  as `rasterize`; Error(InvalidInput) if coverage or a level set are asked for
/// cost:    memory: the grids, the mesh, and some 150 bytes a cell
[[nodiscard]] LimitGrids rasterize_limit(const HexMesh& mesh, std::span<const std::string> fields,
                                         const RasterizeOptions& options);

/// What `rasterize` checks first, of the mesh and of the voxels of the options: before a level of the limit is looked for,
/// which small voxels make expensive.
///
/// throws: Error(InvalidInput) as `rasterize`
void check_voxels(const HexMesh& mesh, const RasterizeOptions& options);

/// The refinement of the options as tables, for meshes with the same cells whose points and values differ: frames of a
/// sequence. The meshes must not have unused points.
///
/// options: refine, on_limit and limit->level are used; a crease angle is ignored: tag creases before
/// throws:  Error(InvalidInput) as `rasterize`
[[nodiscard]] RefinementTables rasterization_tables(const HexMesh& mesh, const RasterizeOptions& options);

/// One part of a volume.
struct GridPart {
    int number = 0;  ///< the number of the part, from 0
    int of = 1;      ///< the number of parts
    std::vector<VdbGrid> grids;
};

/// How a mesh in pieces was rasterized.
struct PartsReport {
    std::size_t blocks = 0;  ///< blocks of voxels
    std::size_t folded = 0;  ///< blocks in which cells fold over; for these, all cells above and below were read, too
    bool converged = true;   ///< the limit is within its tolerance in all cells
};

/// Rasterizes part by part. Together their leaves are those of `rasterize`.
///
/// A mesh in memory is rasterized in slabs across x, one after the other. For a mesh in pieces the space is halved until the
/// voxels of a block and the cells about it fit into the memory; parts are the blocks that have voxels.
///
/// memory_bytes: about the most that the grids of one part take, without a level set; of a mesh in pieces also the cells that
///               are read for it; but a part is at least 32 voxels thick
/// throws:       as `rasterize`; Error(InvalidInput) if a mesh in pieces has no voxel size, or cell numbers, coverage or a
///               level set are asked for; what reading pieces throws
PartsReport rasterize_parts(const MeshSource& source, std::span<const std::string> fields, const RasterizeOptions& options,
                            std::size_t memory_bytes, const std::function<void(GridPart)>& take);

struct GridShare {
    std::vector<VdbGrid> grids;
    ShareRange layers{};  ///< the range of the layers of 32 voxels across x, among those of the mesh
    PartsReport report{};
};

/// Rasterizes one of several shares: a slab across x, for processes that share the work. The slabs are chosen so that their
/// grids take about as much memory each. Together the leaves of all shares are those of `rasterize`; see `join_grids`. Only the
/// pieces that touch the slab are read.
///
/// A share may have no voxels: its grids are empty then.
///
/// throws: Error(InvalidInput) as `rasterize_parts`, or for a share that does not exist
[[nodiscard]] GridShare rasterize_share(const MeshSource& source, std::span<const std::string> fields,
                                        const RasterizeOptions& options, const Share& share);

/// Sums kernels at voxel centres: a grid of floats per channel, the first a fog volume.
///
/// Active are the centres inside the boundary; without a boundary, those where the weights exceed the least weight of
/// `RbfFieldOptions`. A level set needs a boundary.
///
/// channels: by number
/// options:  voxel size, resolution, like, half, mask, level_set, creator, metadata and progress are used
/// throws:   Error(InvalidInput) as `RbfField`, for options out of range, or for more than 2·10⁹ voxels or indices beyond 2³⁰;
///           Error(Cancelled)
/// cost:     1 µs of one core per voxel and channel, parallel; the same for any number of threads. Memory: the grids, twice
[[nodiscard]] std::vector<VdbGrid> rasterize_points(const RbfVolume& volume, std::span<const std::size_t> channels,
                                                    const RasterizeOptions& options = {});

/// A grid of floats with the active voxels of another one and the values of a field there (NaN becomes 0).
///
/// field:  returns the values at many points, world
/// throws: Error(InvalidInput) if the voxels of `where` are not floats
[[nodiscard]] VdbGrid sample_at_voxels(const VdbGrid& where, const std::string& name,
                                       const std::function<std::vector<double>(std::span<const Vec3>)>& field);

}  // namespace subvol
