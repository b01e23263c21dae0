#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "subvol/mesh_io.h"
#include "text_scanner.h"

namespace subvol {

/// An array as a file holds it. at_cells: one tuple a cell of the file (of any kind), else one a point
struct FileArray {
    std::string name;
    int components = 1;
    bool at_cells = false;
    std::vector<double> values;
};

/// What a reader found, before it becomes a mesh.
///
/// hex_numbers: the place of each hex among all the cells of the file, from 0; empty if there are only hexes
/// not_finite:  points with a coordinate that is not finite, and where the text has it: an error if a hex uses the point
struct MeshFile {
    struct NotFinite {
        std::size_t point;
        std::size_t position;
    };
    std::vector<Vec3> points;
    std::vector<std::array<Index, 8>> hexes;
    std::vector<std::size_t> hex_numbers;
    std::vector<FileArray> arrays;
    std::vector<NotFinite> not_finite;
    std::vector<std::string> warnings;
};

/// How a format calls and counts its points and cells.
struct Wording {
    std::string_view point;
    std::string_view cell;
    std::size_t first;

    [[nodiscard]] std::string name_point(std::size_t p) const { return std::string(point) + " " + std::to_string(p + first); }
    [[nodiscard]] std::string name_cell(std::size_t c) const { return std::string(cell) + " " + std::to_string(c + first); }
};

/// Reads MEDIT ASCII.
[[nodiscard]] ReadResult read_medit(std::string_view text, std::string_view file);

/// Reads legacy VTK, ASCII, unstructured grid.
[[nodiscard]] ReadResult read_legacy_vtk(std::string_view text, std::string_view file);

/// Reads three coordinates of the point that comes next and appends it. of: as in Place
void read_point(TextScanner& in, MeshFile& into, const Wording& wording, std::size_t of);

/// Refuses a hex that has a corner twice. position: its place in the text; cell: its place among the cells, from 0
void check_corners(const TextScanner& in, std::size_t position, const std::array<Index, 8>& hex, std::size_t cell,
                   const Wording& wording);

/// Makes the mesh of what was found: left-handed hexes turned, cell arrays carried over to the points, all checked.
[[nodiscard]] ReadResult finish(MeshFile&& found, const TextScanner& in, std::string_view file, const Wording& wording);

/// Writes MEDIT ASCII, version 2.
std::vector<std::string> write_medit(const std::filesystem::path& path, const HexMesh& mesh);

/// Writes VTK XML, UnstructuredGrid, appended raw.
std::vector<std::string> write_vtu(const std::filesystem::path& path, const HexMesh& mesh);

}  // namespace subvol
