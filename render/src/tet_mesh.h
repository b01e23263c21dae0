#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// A face of a tetrahedron: 4 · tetrahedron + the corner opposite to it.
using TetFace = Index;

/// A mesh of tetrahedra that knows its neighbours. A tetrahedron is half a cache line, for a walk needs all of it at once.
///
/// neighbor[k]: the tetrahedron across the face opposite to corner k; kNone on the boundary
struct TetMesh {
    struct Tet {
        std::array<Index, 4> corner;
        std::array<Index, 4> neighbor;
    };
    struct Point {
        Vec3 position;
        double value;
    };
    std::vector<Point> points;
    std::vector<Tet> tets;
    std::vector<TetFace> boundary;
    std::size_t degenerate_tets = 0;
    std::size_t inverted_tets = 0;

    [[nodiscard]] std::array<Index, 3> corners(TetFace face) const {
        const auto& corner = tets[face / 4].corner;
        const std::size_t k = face % 4;
        return {corner[k == 0 ? 1 : 0], corner[k <= 1 ? 2 : 1], corner[k <= 2 ? 3 : 2]};
    }

    // What a walk asks of any mesh.
    [[nodiscard]] std::size_t tet_count() const { return tets.size(); }
    [[nodiscard]] const std::array<Index, 4>& corners_of_tet(Index tet) const { return tets[tet].corner; }
    [[nodiscard]] Index neighbor(Index tet, Index k) const { return tets[tet].neighbor[k]; }
    [[nodiscard]] const Point& point(Index id) const { return points[id]; }
};

/// throws: Error(InvalidInput) if there is not one finite value for every point of a cell, or the mesh is not valid
void check_tet_input(const HexMesh& mesh, std::span<const double> scalar);

/// Splits every cell into 6 and finds the neighbours by sorting the faces. A face of more than two tetrahedra is a boundary
/// of each of them.
///
/// throws: Error(InvalidInput) if the mesh has more cells than 32-bit faces can number
/// cost:   O(n log n), parallel; about 105 bytes a tetrahedron while it sorts, 40 after
[[nodiscard]] TetMesh build_tet_mesh(const HexMesh& mesh, std::span<const double> scalar);

}  // namespace subvol
