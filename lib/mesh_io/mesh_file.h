// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/mesh_io.h"
#include "subvol/mixed_cells.h"
#include "text_scanner.h"

namespace subvol::detail {

/// An array as a file holds it. at_cells: one tuple a cell of the file (of any kind), else one a point
struct FileArray {
    std::string name;
    int components = 1;
    bool at_cells = false;
    std::vector<double> values;
};

/// The cells of one kind. numbers: the place of each among all the cells of the file, from 0; empty where no array asks for it
template <std::size_t N>
struct FileCells {
    std::vector<std::array<Index, N>> corners;
    std::vector<Index> numbers;
};

/// What a reader found, before it becomes a mesh.
///
/// prisms:     in either handedness, for formats differ; as MixedCells else
/// not_finite: points with a coordinate that is not finite, and where the text has it: an error if a cell uses the point
struct MeshFile {
    struct NotFinite {
        std::size_t point;
        std::size_t position;
    };
    std::vector<Vec3> points;
    FileCells<8> hexes;
    FileCells<4> tets;
    FileCells<6> prisms;
    FileCells<5> pyramids;
    std::vector<FileArray> arrays;
    std::vector<NotFinite> not_finite;
    std::vector<std::string> warnings;
};

/// How a format calls and counts its points and cells. point_numbers: of each point, if they are not counted from `first`
struct Wording {
    std::string_view point;
    std::string_view cell;
    std::size_t first;
    std::span<const std::int64_t> point_numbers = {};

    [[nodiscard]] std::string name_point(std::size_t p) const {
        return std::string(point) + " " +
               (point_numbers.empty() ? std::to_string(p + first) : std::to_string(point_numbers[p]));
    }
    [[nodiscard]] std::string name_cell(std::size_t c) const { return std::string(cell) + " " + std::to_string(c + first); }
};

/// Reads MEDIT ASCII.
[[nodiscard]] ReadResult read_medit(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads MEDIT binary, versions 1 to 4.
[[nodiscard]] ReadResult read_meshb(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads legacy VTK, ASCII or BINARY, of every type but POLYDATA and FIELD.
[[nodiscard]] ReadResult read_legacy_vtk(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads VTK XML, UnstructuredGrid.
[[nodiscard]] ReadResult read_vtu(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads VTK XML, StructuredGrid, RectilinearGrid or ImageData: their cells are hexahedra.
[[nodiscard]] ReadResult read_vts(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] ReadResult read_vtr(std::string_view text, std::string_view file, const ReadOptions& options);
[[nodiscard]] ReadResult read_vti(std::string_view text, std::string_view file, const ReadOptions& options);

/// A file of the flow that belongs to a Plot3D grid; without a text there is none.
struct Plot3dFlow {
    std::string_view text;
    std::string_view file;
};

/// Reads Plot3D's whole grids in three dimensions: text, Fortran's records or plain bytes, in either order and precision, of
/// one or several blocks, with blanks or without.
[[nodiscard]] ReadResult read_plot3d(std::string_view text, std::string_view file, const ReadOptions& options,
                                     const Plot3dFlow& flow = {});

/// Reads Gmsh, versions 2, 4.0 and 4.1, ASCII and binary.
[[nodiscard]] ReadResult read_gmsh(std::string_view text, std::string_view file, const ReadOptions& options);

/// Reads Exodus II, the last time step.
///
/// throws: Error(MissingCapability) for a file of HDF5 if this library is built without netCDF's
[[nodiscard]] ReadResult read_exodus(std::string_view text, std::string_view file, const ReadOptions& options);

/// Appends a point that stands at a place in the text.
void add_point(MeshFile& into, const Vec3& point, std::size_t position);

/// Reads three coordinates of the point that comes next and appends it. in: a TextScanner or VtkValues; of: as in Place
template <class Numbers>
void read_point(Numbers& in, MeshFile& into, const Wording& wording, std::size_t of) {
    const Place place{wording.point, static_cast<std::int64_t>(into.points.size() + wording.first), of};
    Vec3 point;
    for (int i = 0; i < 3; ++i) point[i] = in.real(place);
    add_point(into, point, in.position());
}

/// Refuses a cell that has a corner twice. position: its place in the text; cell: its number, from 0; kind: "a hexahedron"
void check_corners(const TextScanner& in, std::size_t position, std::span<const Index> corners, std::size_t cell,
                   const Wording& wording, std::string_view kind);

/// Tells of the cells that are left out, as a list with their counts; refuses a file without any others.
void report_left_out(MeshFile& found, const std::string& list, std::string_view file);

/// Makes the mesh of what was found: ghosts dropped, points welded, left-handed hexes turned, other cells split, cell arrays
/// carried over to the points, all checked.
[[nodiscard]] ReadResult finish(MeshFile&& found, const TextScanner& in, std::string_view file, const Wording& wording,
                                const ReadOptions& options);

/// Writes MEDIT ASCII, version 2.
std::vector<std::string> write_medit(const std::filesystem::path& path, const HexMesh& mesh);

/// Writes VTK XML, UnstructuredGrid, compressed.
std::vector<std::string> write_vtu(const std::filesystem::path& path, const HexMesh& mesh);

}  // namespace subvol::detail
