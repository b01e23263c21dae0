// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "mesh_format.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "subvol/read_options.h"
#include "subvol/shells.h"

namespace subvol::detail {

class Hdf5File;

/// The formats that are built in, by families.
[[nodiscard]] std::span<const FormatFamily> format_families();

/// Returns the format of a file: the one that its first bytes show beyond doubt, else the one that its extension names, in
/// upper or lower case, else the one that the first bytes suggest, unless the name is of a file of another program; for a
/// folder the one whose meshes are folders. Null if there is none.
[[nodiscard]] const MeshFormat* format_of(const std::filesystem::path& path);

/// The same; throws: Error(InvalidInput) that lists all formats if there is none.
[[nodiscard]] const MeshFormat& readable_format(const std::filesystem::path& path);

/// Returns the row of files of other programs if a file's name is of one of them and a reader was set for them; else null.
[[nodiscard]] const MeshFormat* foreign_row(const std::filesystem::path& path);

/// How values at cells are read from a format where the options leave it open; still Auto where each array decides.
[[nodiscard]] CellValues resolved_cell_values(const MeshFormat& format, CellValues chosen);

/// Refuses options that a format has no use for.
void check_options(const MeshFormat& format, const std::filesystem::path& path, const ReadOptions& options);

/// What `read_mesh` does with whatever a reader has read: makes all names printable and those of fields, patches and sets of
/// cells distinct, with a warning, and validates mesh, shells, sets and the bounds of fields.
///
/// throws: Error(InvalidInput) that names the file
void check_read(ReadResult& result, const std::string& file);

// The readers and writers in the rows of the table. Each `NAME_times` gives the times of the steps of a file.

/// Reads MEDIT ASCII.
[[nodiscard]] ReadResult read_medit(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads MEDIT binary, versions 1 to 4.
[[nodiscard]] ReadResult read_meshb(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads legacy VTK, ASCII or BINARY, every type except POLYDATA and FIELD.
[[nodiscard]] ReadResult read_legacy_vtk(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads VTK XML, UnstructuredGrid.
[[nodiscard]] ReadResult read_vtu(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads VTK XML, StructuredGrid, RectilinearGrid or ImageData: their cells are hexahedra.
[[nodiscard]] ReadResult read_vts(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] ReadResult read_vtr(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] ReadResult read_vti(std::string_view text, std::string_view file, const ReadOptions& options);

/// The file with the flow that belongs to a Plot3D grid.
struct Plot3dFlow {
    std::string_view text;  ///< empty if there is none
    std::string_view file;
};

/// The same as parts of a mesh: without the steps of `assemble` that need the whole mesh. A part may have no cells.
[[nodiscard]] MeshFile read_vtu_piece(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] MeshFile read_vts_piece(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] MeshFile read_vtr_piece(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] MeshFile read_vti_piece(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads Plot3D's whole grids in three dimensions: text, Fortran records or plain bytes, in either byte order and precision, of
/// one or several blocks, with or without blanking.
[[nodiscard]] ReadResult read_plot3d(std::string_view text, std::string_view file, const ReadOptions& options,
                                     const Plot3dFlow& flow = {});

/// Reads Gmsh, versions 2, 4.0 and 4.1, ASCII and binary.
[[nodiscard]] ReadResult read_gmsh(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] std::vector<double> gmsh_times(const std::filesystem::path& path);

/// Reads a step of XDMF 2 or 3. file: in its folder are the files of values
[[nodiscard]] ReadResult read_xdmf(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] std::vector<double> xdmf_times(const std::filesystem::path& path);

/// Reads a step of a VTKHDF file, of versions 1 and 2: an unstructured grid, whose partitions are joined, or the finest cells
/// of adaptive mesh refinement.
[[nodiscard]] ReadResult read_vtkhdf(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] ReadResult read_vtkhdf(const Hdf5File& file, const ReadOptions& options);
[[nodiscard]] ReadResult read_vtkhdf_amr(const Hdf5File& file, const ReadOptions& options);

[[nodiscard]] std::vector<double> vtkhdf_times(const std::filesystem::path& path);
[[nodiscard]] std::vector<double> vtkhdf_times(const Hdf5File& file);

/// Reads the finest cells of adaptive mesh refinement in VTK XML, in the images that the file lists.
[[nodiscard]] ReadResult read_amr(const std::filesystem::path& path, const ReadOptions& options);

/// Reads a step of a list of files, and makes one mesh of them.
[[nodiscard]] ReadResult read_collection(const std::filesystem::path& path, const ReadOptions& options);
[[nodiscard]] std::vector<double> pvd_times(const std::filesystem::path& path);
[[nodiscard]] std::vector<double> series_list_times(const std::filesystem::path& path);

/// Writes MEDIT ASCII, version 2. A warning names the patches and sets.
std::vector<std::string> write_medit(const std::filesystem::path& path, const WrittenMesh& written);

/// Writes VTK XML, UnstructuredGrid, compressed, with shells and beams after the cells.
std::vector<std::string> write_vtu(const std::filesystem::path& path, const WrittenMesh& written);

/// Writes Gmsh's version 4.1 as text: patches and sets as physical groups. Fields of 1, 3, 6 and 9 channels are written, those
/// of 6 as symmetric tensors of 9; a warning names the others, and counts creases.
std::vector<std::string> write_gmsh(const std::filesystem::path& path, const WrittenMesh& written);

/// Writes VTKHDF 1.0, compressed.
std::vector<std::string> write_vtkhdf(const std::filesystem::path& path, const WrittenMesh& written);

}  // namespace subvol::detail
