// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// An array as it stood in a file. location: "point" or "cell"; min and max over finite values (vectors: of the length)
struct FieldInfo {
    std::string name;
    std::string location;
    int components = 1;
    double min = 0;
    double max = 0;
};

/// What becomes of tetrahedra, prisms and pyramids.
///
/// Split:  all cells, hexahedra too, are split by `split_into_hexes`, and a warning says so
/// Ignore: they are left out, and a warning says so
/// Refuse: they are an error
enum class OtherCells { Split, Ignore, Refuse };

/// weld: join points that are no farther apart (world units; 0: at exactly the same place), as the borders of pieces need; the
/// one
///       that comes first stays, with its values. A warning says how many. Nothing: they stay apart
struct ReadOptions {
    OtherCells other_cells = OtherCells::Split;
    std::optional<double> weld = {};
};

struct ReadResult {
    HexMesh mesh;  // validated; a cell array became a point array by the volume-weighted mean over incident cells
    std::vector<FieldInfo> fields;
    std::vector<std::string> warnings;  // what was left out, turned round or converted, one sentence each
};

/// Reads a mesh; the format follows from the file name: MEDIT `.mesh` and `.meshb`, legacy VTK `.vtk` (ASCII and BINARY,
/// unstructured, structured and rectilinear grids, structured points), VTK XML `.vtu`, `.vts`, `.vtr` and `.vti` (all encodings
/// and compressors), Gmsh `.msh` (2, 4.0 and 4.1, ASCII and binary), Plot3D `.xyz` and `.p3d`, with the flow of the same name
/// in
/// `.q`, Exodus II `.e`, `.exo`, `.ex2` and `.g` (the last time step).
///
/// Cells of lower dimension are left out, and of cells of higher order the corners are taken, with a warning.
/// throws: Error(InvalidInput) if options.weld is negative or makes corners of one cell the same;
///         Error(MissingCapability) for Exodus II as HDF5 in a build without netCDF's library;
///         Error(Io) if the file cannot be opened; Error(InvalidInput) if it is malformed, naming the line, and the cell or
///         point as the file counts them; never allocates by a number from the file that the file's size does not bear out
[[nodiscard]] ReadResult read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Writes a mesh: MEDIT `.mesh` (geometry only) or VTK XML `.vtu` (compressed, with all attributes). Written beside and
/// renamed, so that there is never half a file.
///
/// returns: warnings, such as attributes that the format cannot hold
/// throws:  Error(InvalidInput) for an unknown extension, Error(Io) if it cannot be written
std::vector<std::string> write_mesh(const std::filesystem::path& path, const HexMesh& mesh);

}  // namespace subvol
