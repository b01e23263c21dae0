// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "subvol/mixed_mesh.h"

namespace subvol::detail {

enum class CellKind : std::uint8_t { Tet, Octahedron, Prism, Pyramid, Hex };
inline constexpr std::size_t kCellKinds = 5;

/// A kind of cell as tables of corner numbers, which are VTK's:
///
///     tetrahedron   0 1 2 counter-clockwise seen from 3
///     octahedron    opposite corners in pairs, as +x −x, +y −y, +z −z: 0 1, 2 3, 4 5
///     prism         0 1 2 counter-clockwise seen from 3 4 5, which lie above them
///     pyramid       0 1 2 3 counter-clockwise seen from the apex 4
///     hexahedron    0 1 2 3 counter-clockwise seen from 4 5 6 7, which lie above them
struct CellTable {
    std::string_view name;
    std::size_t corners;
    std::span<const std::array<int, 2>> edges;
    /// Counter-clockwise seen from outside a right-handed cell; the last corner of a triangle is −1
    std::span<const std::array<int, 4>> faces;
};

namespace tables {
inline constexpr std::array<std::array<int, 2>, 6> kTetEdges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
inline constexpr std::array<std::array<int, 4>, 4> kTetFaces{{{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}}};
inline constexpr std::array<std::array<int, 2>, 12> kOctEdges{
    {{0, 2}, {0, 3}, {0, 4}, {0, 5}, {1, 2}, {1, 3}, {1, 4}, {1, 5}, {2, 4}, {2, 5}, {3, 4}, {3, 5}}};
inline constexpr std::array<std::array<int, 4>, 8> kOctFaces{
    {{0, 2, 4, -1}, {0, 5, 2, -1}, {0, 4, 3, -1}, {0, 3, 5, -1}, {1, 4, 2, -1}, {1, 2, 5, -1}, {1, 3, 4, -1}, {1, 5, 3, -1}}};
inline constexpr std::array<std::array<int, 2>, 9> kPrismEdges{
    {{0, 1}, {1, 2}, {0, 2}, {3, 4}, {4, 5}, {3, 5}, {0, 3}, {1, 4}, {2, 5}}};
inline constexpr std::array<std::array<int, 4>, 5> kPrismFaces{
    {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
inline constexpr std::array<std::array<int, 2>, 8> kPyramidEdges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}};
inline constexpr std::array<std::array<int, 4>, 5> kPyramidFaces{
    {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};
inline constexpr std::array<std::array<int, 2>, 12> kHexEdges{
    {{0, 1}, {3, 2}, {4, 5}, {7, 6}, {0, 3}, {1, 2}, {4, 7}, {5, 6}, {0, 4}, {1, 5}, {3, 7}, {2, 6}}};
inline constexpr std::array<std::array<int, 4>, 6> kHexFaces{
    {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};
}  // namespace tables

inline constexpr std::array<CellTable, kCellKinds> kCellTables{{{"tetrahedron", 4, tables::kTetEdges, tables::kTetFaces},
                                                                {"octahedron", 6, tables::kOctEdges, tables::kOctFaces},
                                                                {"prism", 6, tables::kPrismEdges, tables::kPrismFaces},
                                                                {"pyramid", 5, tables::kPyramidEdges, tables::kPyramidFaces},
                                                                {"hexahedron", 8, tables::kHexEdges, tables::kHexFaces}}};

[[nodiscard]] inline const CellTable& table_of(CellKind kind) {
    return kCellTables[static_cast<std::size_t>(kind)];
}

/// Calls call(kind, cells) for the cells of each kind.
template <class Mesh, class Call>
void each_kind_of(Mesh& mesh, const Call& call) {
    call(CellKind::Tet, mesh.tets);
    call(CellKind::Octahedron, mesh.octahedra);
    call(CellKind::Prism, mesh.prisms);
    call(CellKind::Pyramid, mesh.pyramids);
    call(CellKind::Hex, mesh.hexes);
}

/// The corner's point; `corner` from a table.
template <class Cell>
[[nodiscard]] Index at(const Cell& cell, int corner) {
    return cell[static_cast<std::size_t>(corner)];
}

/// The ends of an edge of a cell, the smaller first.
template <class Cell>
[[nodiscard]] std::array<Index, 2> edge_of(const Cell& cell, const std::array<int, 2>& ends) {
    const Index a = at(cell, ends[0]), b = at(cell, ends[1]);
    return a < b ? std::array<Index, 2>{a, b} : std::array<Index, 2>{b, a};
}

/// The corners of a face in the order of its table; the fourth is kNone if it is a triangle.
template <class Cell>
[[nodiscard]] std::array<Index, 4> face_of(const Cell& cell, const std::array<int, 4>& face) {
    return {at(cell, face[0]), at(cell, face[1]), at(cell, face[2]), face[3] < 0 ? kNone : at(cell, face[3])};
}

/// Cuts an octahedron into four tetrahedra along the shortest of its diagonals, the first of those that are equally short.
void cut_octahedron(const MixedMesh& mesh, const std::array<Index, 6>& corners, std::vector<std::array<Index, 4>>& tets);

/// A mixed mesh in hexahedra (`in_hexahedra`), and the cell that each of these is in.
struct HexesOfMixed {
    HexMesh mesh;
    std::vector<Index> cells;  ///< counted through the tetrahedra, octahedra, prisms, pyramids and hexahedra
};

[[nodiscard]] HexesOfMixed hexahedra_of(const MixedMesh& mesh);

/// throws: Error(InvalidInput) unless schemes of tetrahedra refine so often
void check_tet_levels(int levels);

}  // namespace subvol::detail
