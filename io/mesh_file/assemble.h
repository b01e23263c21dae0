// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_file.h"
#include "subvol/read_options.h"

namespace subvol::detail {

/// Makes a mesh of what a reader found. The steps, in this order: drop ghost cells, refuse used points that are not finite,
/// weld points, split curved hexahedra, take collapsed cells as what they look like, turn left-handed hexahedra, split other
/// cells into hexahedra, move cell arrays to the points, validate, tag sharp faces and creases.
///
/// in, file, names: for messages
/// throws: Error(InvalidInput) as `read_mesh`
[[nodiscard]] ReadResult assemble(MeshFile&& found, const TextScanner& in, std::string_view file, const EntityNames& names,
                                  const ReadOptions& options);

/// The same for what was put together from several files, whose points are known to be finite.
[[nodiscard]] ReadResult assemble(MeshFile&& found, std::string_view file, const EntityNames& names,
                                  const ReadOptions& options);

/// Refuses points that are not finite and that a cell uses.
void refuse_not_finite(const MeshFile& found, const TextScanner& in, const EntityNames& names);

/// VTK's array of ghosts, at the cells or at the points: a sum of bits for each.
inline constexpr std::string_view kGhostArray = "vtkGhostType";
inline constexpr unsigned kDuplicateCell = 1, kRefinedCell = 8, kHiddenCell = 32;
inline constexpr unsigned kHiddenPoint = 2;

/// Turns VTK's older array of ghosts at the cells, which has the distance of each from the piece's own cells, into the newer
/// one.
void take_ghost_levels(MeshFile& found);

/// Whether a value of the array of ghosts leaves a cell out, and whether it hides a point.
[[nodiscard]] bool leaves_out_cell(double ghost);
[[nodiscard]] bool hides_point(double ghost);

/// What is said of cells that were left out as ghosts, of cells that were turned round, and of those that fold over.
[[nodiscard]] std::string ghosts_left_out(std::size_t count);
[[nodiscard]] std::string cells_turned(std::size_t turned, std::size_t cells);
[[nodiscard]] std::string cells_folded(std::size_t folded, std::size_t cells);

/// How many cells of each kind there are.
struct CellCounts {
    std::size_t hexes = 0, tets = 0, prisms = 0, pyramids = 0;
};

/// What is said of a mesh that was split into hexahedra. tets_cut: as in HexSplit; children: the hexahedra
[[nodiscard]] std::string split_report(const CellCounts& counts, std::size_t tets_cut, std::size_t children);

/// The points of a cell.
[[nodiscard]] std::array<Vec3, 8> corners_of(const HexMesh& mesh, const std::array<Index, 8>& cell);

/// Whether the Jacobian is negative at a corner of a hexahedron.
[[nodiscard]] bool is_folded(const std::array<Vec3, 8>& corners);

/// Leaves out the cells that the array of ghosts marks as duplicates of another piece's cells, as refined or as hidden, and the
/// cells with a hidden point, with a warning that counts them. Removes the array.
void drop_ghosts(MeshFile& found);

/// Joins points at the same place: cells then use the first of them. Adds a warning that counts the points.
///
/// tolerance: a point is joined to the first one before it at this distance or less; world units, 0: at exactly the same place
/// throws:    Error(InvalidInput) if a cell would then have the same corner twice and the tolerance is not 0
/// cost:      O(n) if few points lie within a tolerance of each other
void weld_points(MeshFile& found, double tolerance, std::string_view file, const EntityNames& names);

/// Adds a warning if cells, or groups of a few cells, share no point with others though many of their points lie at the places
/// of others, as programs with discontinuous fields write them.
///
/// cost: counts the points of most meshes; O(n) where there are many for the cells
void say_points_of_their_own(MeshFile& found);

/// Adds a warning if points hang: corners of hexahedra in the middle of an edge or a face of a larger one.
///
/// cost: O(n); looks for points only where edges differ in length by a factor of 1.8 and more
void say_hanging_points(MeshFile& found);

/// Splits the hexahedra that have hanging points on their edges and faces from their middle, so that all cells fit together:
/// the mesh is then cut into tetrahedra. Adds a warning with the number of these hexahedra.
void join_hanging_points(MeshFile& found);

/// Splits all hexahedra of a mesh with curved ones into smaller ones with points on the curved shape, and evaluates the arrays
/// at the points there. Opposite edges of a cell are split alike, so that neighbours share their points. Adds a warning with
/// the estimated error, which is the sum of h² f''/8 over the three directions.
///
/// tolerance: of the shape, in parts of the mesh's diagonal; of the fields 400 times that, in parts of their ranges
/// returns:   the errors that are left; points were replaced if it says `split()`. Nothing if there are no curved cells, and
///            beside other kinds of cells, cells that repeat points and sharp groups: then a warning says that only the corners
///            are used
/// throws:    Error(InvalidInput) if the degrees do not fit to the number of nodes, a rational weight is not positive, or a
///            value at a node is not finite
std::optional<CurvedReport> split_curved(MeshFile& found, double tolerance, std::string_view file, const EntityNames& names);

/// Takes cells that repeat points as the prisms, pyramids and tetrahedra that they look like; other shapes are cut into
/// tetrahedra. Cells without volume are left out. Adds warnings with the counts.
///
/// other_cells: Ignore: collapsed cells are left out
/// returns:     whether all cells have to be cut into tetrahedra, so that they fit to those of the other shapes
/// throws:      Error(InvalidInput) if a cell repeats a point at corners that no collapsed edges join
[[nodiscard]] bool take_collapsed(MeshFile& found, OtherCells other_cells, std::string_view file, const EntityNames& names);

}  // namespace subvol::detail
