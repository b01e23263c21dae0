// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "subvol/read_options.h"
#include "subvol/shells.h"

namespace subvol {

/// Reads a mesh. The first bytes of the file decide the format where they show it beyond doubt (with a warning if the extension
/// names another one), else the extension, or if that is unknown what the first bytes suggest:
///
///   .mesh, .meshb          MEDIT, ASCII and binary
///   .vtk                   legacy VTK, ASCII and BINARY: unstructured, structured and rectilinear grids, structured points
///   .vtu, .vts, .vtr, .vti VTK XML, all encodings and compressors
///   .msh                   Gmsh 2, 4.0 and 4.1, ASCII and binary
///   .xyz, .p3d             Plot3D, with the flow of the same name in .q
///   .e, .exo, .ex2, .g     Exodus II
///   .pvtu, .pvts, .pvtr, .pvti, .vtm  the pieces or blocks of VTK, in files of their own
///   .vth, .vthb            the finest cells of adaptive mesh refinement of VTK, in images of their own
///   .pvd, .series          steps of VTK and ParaView, in files of their own
///   .vtkhdf, .hdf          VTKHDF, unstructured grids and adaptive mesh refinement
///   .xdmf, .xmf            XDMF 2 and 3, with values in the text, in HDF5 and in binary files
///   .cgns                  CGNS in HDF5
///   .case                  EnSight Gold
///   .frd                   CalculiX's results
///   .foam, .inp            an OpenFOAM case, as its folder; Abaqus and CalculiX decks
///   .svw                   wavelets, as `write_wavelet_file` writes them
///
/// Cells of lower dimension are left out, but for ReadResult::shells; curved hexahedra are split as ReadOptions says, and of
/// other curved cells only the corners are used. A cell that repeats points is taken as the prism, pyramid or tetrahedron that
/// it looks like, and left out if it has no volume. A field with a value that is not finite at a point or cell of the mesh is
/// left out, but not if no field would be left. All give a warning. Memory is never allocated by a number in the file that
/// the file is too short for.
///
/// throws: Error(Io) if the file cannot be opened;
///         Error(InvalidInput) if it is malformed, naming the line, and the cell or point as the file counts them;
///         Error(InvalidInput) if options.weld is negative, or positive and makes two corners of a cell the same;
///         Error(InvalidInput) if options.curved_tolerance is not positive, if there is no such step or block;
///         Error(InvalidInput) if there is no group that options.sharp names, the format has none, or one of its faces is not a
///         face of a cell;
///         Error(MissingCapability) for a file of HDF5 if the library is built without HDF5
[[nodiscard]] ReadResult read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Writes a mesh: MEDIT `.mesh` (geometry only), VTK XML `.vtu` or VTKHDF `.vtkhdf` (compressed, with all attributes, patches
/// and sets), or for solvers Gmsh `.msh`, Abaqus `.inp` (without attributes), Exodus II `.e` or a case of OpenFOAM, `.foam`
/// with its folders beside it, which are not replaced. Files are written under temporary names and then renamed, so that they
/// are never incomplete.
///
/// shells:  become quads and lines after the cells; their points that the mesh does not have come after its points. `.vtu` only
/// sets:    those without sides or cells are not written
/// returns: warnings, for example about attributes or patches that the format cannot hold
/// throws:  Error(InvalidInput) as `validate`, for an unknown extension, or for another extension than `.vtu` if there are
///          shells; Error(Io) if the file cannot be written; Error(MissingCapability) for `.vtkhdf` if the library is built
///          without HDF5
std::vector<std::string> write_mesh(const std::filesystem::path& path, const HexMesh& mesh, const Shells& shells = {},
                                    const MeshSets& sets = {});

/// Whether `read_mesh` reads a file: by its first bytes and its extension.
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& path);

/// The extensions of the files that `read_mesh` reads and `write_mesh` writes, such as ".vtu".
[[nodiscard]] std::vector<std::string> readable_mesh_extensions();
[[nodiscard]] std::vector<std::string> writable_mesh_extensions();

}  // namespace subvol
