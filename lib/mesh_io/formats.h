// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "subvol/mesh_io.h"

namespace subvol::detail {

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

/// The file with the flow that belongs to a Plot3D grid. text: empty if there is none
struct Plot3dFlow {
    std::string_view text;
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

/// Reads a step of Exodus II.
///
/// throws: Error(MissingCapability) for an HDF5 file if this library is built without HDF5
[[nodiscard]] ReadResult read_exodus(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] std::vector<double> exodus_times(const std::filesystem::path& path);

/// Writes MEDIT ASCII, version 2.
std::vector<std::string> write_medit(const std::filesystem::path& path, const HexMesh& mesh);

/// Writes VTK XML, UnstructuredGrid, compressed.
std::vector<std::string> write_vtu(const std::filesystem::path& path, const HexMesh& mesh);
/// The same with valid sheets and curves after the cells.
std::vector<std::string> write_vtu(const std::filesystem::path& path, const HexMesh& mesh, const Sheets& sheets);

}  // namespace subvol::detail
