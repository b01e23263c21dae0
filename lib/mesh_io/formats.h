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
/// throws: Error(MissingCapability) for an HDF5 file if this library is built without netCDF
[[nodiscard]] ReadResult read_exodus(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] std::vector<double> exodus_times(const std::filesystem::path& path);

/// Writes MEDIT ASCII, version 2.
std::vector<std::string> write_medit(const std::filesystem::path& path, const HexMesh& mesh);

/// Writes VTK XML, UnstructuredGrid, compressed.
std::vector<std::string> write_vtu(const std::filesystem::path& path, const HexMesh& mesh);

/// A format of mesh files.
///
/// extensions: in lower case, unused ones empty
/// write:      null if the library only reads the format
/// groups:     whether its groups of faces and edges are read
/// blocks:     whether it has named parts, which ReadOptions::blocks chooses
/// times:      the times of the steps of a file; null if a file of this format is one step
/// piece:      reads a file as a part of a mesh, before it is assembled; null if such files are no parts
struct MeshFormat {
    std::array<std::string_view, 4> extensions;
    std::string_view name;
    ReadResult (*read)(const std::filesystem::path& path, const ReadOptions& options);
    std::vector<std::string> (*write)(const std::filesystem::path& path, const HexMesh& mesh);
    bool groups = false;
    bool blocks = false;
    std::vector<double> (*times)(const std::filesystem::path& path) = nullptr;
    MeshFile (*piece)(std::string_view text, std::string_view file, const ReadOptions& options) = nullptr;
};

[[nodiscard]] std::span<const MeshFormat> mesh_formats();

/// The format that a file name's extension names, in upper or lower case; null if there is none.
[[nodiscard]] const MeshFormat* format_of(const std::filesystem::path& path);

/// The same; throws: Error(InvalidInput) that lists all formats if there is none.
[[nodiscard]] const MeshFormat& readable_format(const std::filesystem::path& path);

/// Refuses options that a format has no use for.
void check_options(const MeshFormat& format, const std::filesystem::path& path, const ReadOptions& options);

}  // namespace subvol::detail
