// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <string>

#include "subvol/hex_mesh.h"

namespace subvol::test {

inline std::string number(double value) {
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

/// The points, one per line; each followed by `suffix`.
inline std::string point_lines(const HexMesh& mesh, const std::string& suffix = "") {
    std::string text;
    for (const Vec3& x : mesh.points) text += number(x.x) + " " + number(x.y) + " " + number(x.z) + suffix + "\n";
    return text;
}

/// The cells, one per line between `prefix` and `suffix`; points are counted from `first`.
inline std::string cell_lines(const HexMesh& mesh, Index first, const std::string& prefix = "",
                              const std::string& suffix = "") {
    std::string text;
    for (const auto& cell : mesh.cells) {
        text += prefix;
        for (std::size_t k = 0; k < 8; ++k) text += (k > 0 ? " " : "") + std::to_string(cell[k] + first);
        text += suffix + "\n";
    }
    return text;
}

inline std::string with_crlf(const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '\n' ? "\r\n" : std::string(1, c);
    return result;
}

inline std::string medit_text(const HexMesh& mesh) {
    return "MeshVersionFormatted 1\nDimension 3\nVertices\n" + std::to_string(mesh.points.size()) + "\n" +
           point_lines(mesh, " 0") + "Hexahedra\n" + std::to_string(mesh.cells.size()) + "\n" + cell_lines(mesh, 1, "", " 0") +
           "End\n";
}

/// Legacy VTK 3.0 without arrays: further sections can be appended.
inline std::string vtk_text(const HexMesh& mesh, const std::string& type = "12") {
    const std::string cells = std::to_string(mesh.cells.size());
    std::string text = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                       std::to_string(mesh.points.size()) + " double\n" + point_lines(mesh) + "CELLS " + cells + " " +
                       std::to_string(9 * mesh.cells.size()) + "\n" + cell_lines(mesh, 0, "8 ") + "CELL_TYPES " + cells + "\n";
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) text += type + "\n";
    return text;
}

/// Gmsh 2 without arrays. tags: their number, then the tags
inline std::string gmsh_text(const HexMesh& mesh, const std::string& tags) {
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(mesh.points.size()) + "\n";
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const Vec3& x = mesh.points[p];
        text += std::to_string(p + 1) + " " + number(x.x) + " " + number(x.y) + " " + number(x.z) + "\n";
    }
    return text + "$EndNodes\n$Elements\n" + std::to_string(mesh.cells.size()) + "\n" +
           cell_lines(mesh, 1, "1 5 " + tags + " ") + "$EndElements\n";
}

/// `text` with the first occurrence of `from` replaced by `to`.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

}  // namespace subvol::test
