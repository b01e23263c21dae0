// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/limit_level.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"
#include "subvol/refine.h"
#include "subvol/vdb_grid.h"

namespace subvol {

/// half_width_voxels: how far from the surface voxels are active, to both sides; 1 to 1000
struct LevelSetOptions {
    std::string name = "sdf";
    double half_width_voxels = 3;
};

/// voxel_size_world: > 0, or 0 to take `resolution`; resolution: voxels along the longest side of the bounding box
/// like:             instead of both: a grid whose voxels are taken over, wherever they are; its transform must be linear
/// refine, on_limit: what is rasterized: the trilinear cells of the refined mesh (levels 0: of the mesh as it is), its vertices
///                   where they are or moved to the limit; never more of it in memory than some control cells
/// limit:            null, or what stands for the limit: its level and its curved cells are taken, instead of refine.levels
///                   and on_limit
/// tables:           what `rasterization_tables` made of a mesh of the same cells: nothing of the refinement is computed again,
///                   but the whole refined mesh is in memory. The grids are the same; of a limit, those of cells whose
///                   nodes are all of the level after its own
/// half:             floats stored as 16-bit floats
/// cell_numbers:     one more grid, whole numbers named "cell": the control cell that a voxel lies in
/// mask:             one more grid, of bits, named "mask": where the volume is
/// coverage:         one more grid of floats, named "coverage": the part of each voxel that the volume fills, by 4³ samples; it
///                   is active wherever that is above zero
/// level_set:        one more grid of floats: the distance to the volume's boundary in world units, exact in a narrow band
///                   about it, negative at the centres that the volume holds; beyond the band ± its half width, inactive
/// metadata:         names and texts that every grid carries
struct RasterizeOptions {
    double voxel_size_world = 0;
    int resolution = 200;
    const VdbGrid* like = nullptr;
    RefineOptions refine{.levels = 0};
    bool on_limit = false;
    const LimitCells* limit = nullptr;
    const RefinementTables* tables = nullptr;
    bool half = false;
    bool cell_numbers = false;
    bool mask = false;
    bool coverage = false;
    std::optional<LevelSetOptions> level_set{};
    std::string creator = "OpenSubVol";
    std::vector<std::pair<std::string, std::string>> metadata{};
    Progress* progress = nullptr;
};

/// Rasterizes attributes of a hexahedral mesh: cubic voxels, values at voxel centres, active where the centre lies inside the
/// mesh. One channel becomes a float grid, three a grid of vectors; the first field, if it has one channel, is a fog volume.
/// Leaves that are full of one value become tiles.
///
/// A cell's tetrahedra decide what is inside (`split_cell`; those of refined cells start at the corner that is smallest in x,
/// then y, then z), its trilinear map where in it. A centre on the boundary counts as if it lay 1e-6 voxels further up all
/// axes: a box that fits the voxels fills its volume exactly, and boxes that touch share none. Folded cells hold no centre that
/// the mesh's boundary does not go round. Where cells overlap, the control
/// cell with the smallest id counts. Parallel over bricks of leaves, the same for any number of threads. throws:
/// Error(InvalidInput) if the mesh is not valid, a field is missing, has two or more than three channels or does not fit
///         its float, a level set is asked for with voxels that are no cubes or with another half width, or the voxel size is
///         not positive or below OpenVDB's least of 1.45e-5, makes more than 2·10⁹ voxels or voxel numbers beyond 2³⁰;
///         Error(Cancelled)
/// cost:   memory: the grids, and some 20 MB, or where the mesh is refined some 150 MB and twice the mesh
[[nodiscard]] std::vector<VdbGrid> rasterize(const HexMesh& mesh, std::span<const std::string> fields,
                                             const RasterizeOptions& options = {});

/// The refinement that the options ask for, for meshes of the same cells without unused points, whose points and values differ:
/// frames of a sequence.
///
/// options: refine, on_limit and the level of `limit` count; a crease angle is not used, tag creases before
/// throws:  Error(InvalidInput) as `rasterize`
[[nodiscard]] RefinementTables rasterization_tables(const HexMesh& mesh, const RasterizeOptions& options);

/// One part of a volume. number: from 0; of: how many there are
struct GridPart {
    int number = 0, of = 1;
    std::vector<VdbGrid> grids;
};

/// The same in slabs of 32 voxels and more across x, one after the other, so that the grids of one take no more than about so
/// many bytes, if 32 voxels take less; a level set comes on top. Put together, their leaves are those of `rasterize`.
///
/// throws: as `rasterize`
void rasterize_parts(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options,
                     std::size_t memory_bytes, const std::function<void(GridPart)>& take);

/// The sums of kernels at voxel centres, a grid of floats a channel, the first a fog volume.
///
/// Active are the centres that the boundary holds, or without a boundary those where the weights are above the least of
/// `RbfFieldOptions`. A level set needs a boundary.
/// channels: by their numbers
/// options:  those of voxels, half, mask, level_set, creator, metadata and progress count
/// throws:   Error(InvalidInput) as `RbfField`, if the options are not right, or if there would be more than 2·10⁹ voxels or
///           numbers beyond 2³⁰; Error(Cancelled)
/// cost:     1 µs of one core a voxel and channel, parallel; the same for any number of threads. Memory: the grids, twice
[[nodiscard]] std::vector<VdbGrid> rasterize_points(const RbfVolume& volume, std::span<const std::size_t> channels,
                                                    const RasterizeOptions& options = {});

/// A grid of floats, active where another one is, with the values of a field there (NaN becomes 0).
///
/// field:  the values at many points, world
/// throws: Error(InvalidInput) if the voxels of the other are no floats
[[nodiscard]] VdbGrid sample_at_voxels(const VdbGrid& where, const std::string& name,
                                       const std::function<std::vector<double>(std::span<const Vec3>)>& field);

}  // namespace subvol
